// Goes through all pairs whose boxes overlap, leaves out those that cannot touch, and finds the
// contacts of the rest on all threads.
#include "hull_search.h"

#include "bodies.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

namespace pluvia {

namespace {

// How many pairs ahead the memory is asked for what a pair carries.
constexpr std::size_t AHEAD = 6;

// The same where little is done with each.
constexpr std::size_t FAR_AHEAD = 32;

// Pairs of a block, which a thread takes at once: enough to pay for taking them, few
// enough for all threads to end together.
constexpr std::size_t BLOCK = 256;
constexpr std::size_t FIND_AT_ONCE = 256; // where contacts are found

} // namespace

void *HullDispatcher::allocateCollisionAlgorithm(int) {
    throw std::logic_error("Bullet finds a contact where Pluvia does");
}

HullSearch::HullSearch(HullCollision &collision, HullDispatcher &dispatcher, Workers &workers)
    : collision_(collision), dispatcher_(dispatcher), workers_(workers),
      scratch_(static_cast<std::size_t>(workers.count())) {}

// As Bullet's near callback, for pairs of hulls only: leaves out what cannot touch, and writes
// nothing of the pair. Every body takes part in every step, so nothing else is asked.
void HullSearch::take(btBroadphasePair &pair, Block &block) {
    const HullBodies &bodies = collision_.bodies;
    auto *algorithm = static_cast<HullAlgorithm *>(pair.m_algorithm);
    const std::size_t a =
        algorithm != nullptr ? algorithm->at_a() : HullBodies::index(*pair.m_pProxy0);
    const std::size_t b =
        algorithm != nullptr ? algorithm->at_b() : HullBodies::index(*pair.m_pProxy1);
    const HullRange &range_a = bodies.range(a);
    const HullRange &range_b = bodies.range(b);
    const double travelled = range_a.travelled + range_b.travelled;
    if (algorithm != nullptr &&
        algorithm->rests(travelled, static_cast<double>(range_a.around + range_b.around))) {
        return;
    }
    if (!range_a.meets(range_b) && (algorithm == nullptr || algorithm->points() == 0)) {
        return;
    }
    if (algorithm == nullptr) {
        block.fresh.push_back({&pair, block.end});
    }
    work_[block.end++] = {algorithm, &bodies.body(a), &bodies.body(b), travelled, 0};
}

void HullSearch::cull(btBroadphasePair *first, std::size_t count, std::size_t number) {
    Block &block = blocks_[number];
    block.begin = block.end = number * BLOCK;
    block.fresh.clear();
    for (std::size_t i = block.begin; i < std::min(count, block.begin + BLOCK); ++i) {
        __builtin_prefetch(first[std::min(i + FAR_AHEAD, count - 1)].m_algorithm);
        take(first[i], block);
    }
}

// Sorts the pairs by thread.
void HullSearch::send_home(const std::vector<std::uint16_t> &homes) {
    const std::size_t threads = scratch_.size();
    const auto home = [&](const Work &work) -> std::size_t {
        const auto of = [&](const HullBody &body) {
            const auto number = static_cast<std::size_t>(body.number);
            return number < homes.size() ? std::size_t{homes[number]} : threads;
        };
        const std::size_t first = std::min(of(*work.a), of(*work.b));
        return first < threads ? first : 0;
    };
    const auto each = [&](const auto &what) {
        for (const Block &block : blocks_) {
            for (std::size_t i = block.begin; i < block.end; ++i) {
                what(i, ends_[home(work_[i])]);
            }
        }
    };
    ends_.assign(threads, 0);
    each([](std::size_t, std::size_t &end) { ++end; });
    std::size_t before = 0;
    for (std::size_t &end : ends_) {
        before += std::exchange(end, before);
    }
    order_.resize(before);
    each([&](std::size_t i, std::size_t &end) { order_[end++] = static_cast<std::uint32_t>(i); });
}

void HullSearch::find(std::size_t begin, std::size_t end, PairScratch &scratch) {
    for (std::size_t k = begin; k < end; ++k) {
        ask_ahead(k, end);
        Work &work = work_[order_[k]];
        work.algorithm->find(*work.a, *work.b, work.travelled, scratch);
        work.points = work.algorithm->points();
    }
}

// In the order of the pairs.
void HullSearch::list_touching() {
    std::size_t all = 0;
    for (Block &block : blocks_) {
        block.touching = all;
        for (std::size_t i = block.begin; i < block.end; ++i) {
            all += work_[i].points > 0;
        }
    }
    std::vector<Touching> &touching = collision_.touching;
    touching.resize(all);
    workers_.each(blocks_.size(), 1, [&](std::size_t b) {
        std::size_t next = blocks_[b].touching;
        for (std::size_t i = blocks_[b].begin; i < blocks_[b].end; ++i) {
            const Work &work = work_[i];
            if (work.points > 0) {
                touching[next++] = {&work.algorithm->state(), work.a, work.b, work.points};
            }
        }
    });
}

// Asks the memory for what the pairs after number `k` of the order carry, and then for what
// they will read of the hulls.
void HullSearch::ask_ahead(std::size_t k, std::size_t end) const {
    if (k + AHEAD < end) {
        const Work &work = work_[order_[k + AHEAD]];
        prefetch(*work.algorithm);
        __builtin_prefetch(work.a->hull);
        __builtin_prefetch(work.b->hull);
    }
    if (k + AHEAD / 2 < end) {
        const Work &work = work_[order_[k + AHEAD / 2]];
        work.algorithm->ask_for_hulls(*work.a->hull, *work.b->hull);
    }
}

void HullSearch::find(btOverlappingPairCache &pairs, const std::vector<std::uint16_t> &homes) {
    btBroadphasePair *const first = pairs.getOverlappingPairArrayPtr();
    const auto count = static_cast<std::size_t>(pairs.getNumOverlappingPairs());
    work_.resize(count);
    blocks_.resize((count + BLOCK - 1) / BLOCK);
    workers_.each(blocks_.size(), 1, [&](std::size_t b) { cull(first, count, b); });
    // Room for what pairs carry is given out by one thread.
    for (const Block &block : blocks_) {
        for (const auto &[pair, at] : block.fresh) {
            Work &work = work_[at];
            const PairValue &value = collision_.materials->of(work.a->number, work.b->number);
            work.algorithm = new (dispatcher_.room())
                HullAlgorithm(collision_, value, HullBodies::index(*pair->m_pProxy0),
                              HullBodies::index(*pair->m_pProxy1));
            pair->m_algorithm = work.algorithm;
        }
    }
    send_home(homes);
    const Share all{order_.size(), FIND_AT_ONCE, FIND_AT_ONCE, ends_.data()};
    workers_.share(&all, 1, [&](std::size_t, int worker, std::size_t begin, std::size_t end) {
        find(begin, end, scratch_[worker]);
    });
    list_touching();
}

} // namespace pluvia
