#include "hull_search.h"

#include "bodies.h"
#include "prefetch.h"

#include <algorithm>
#include <new>
#include <stdexcept>

namespace pluvia {

namespace {

// So many pairs ahead the memory is asked for what a pair carries.
constexpr std::size_t AHEAD = 6;

// And so many where little is done with each.
constexpr int FAR_AHEAD = 32;

// Pairs that a thread takes at once: enough to pay for taking them, few enough
// for all threads to end together.
constexpr std::size_t PAIRS_AT_ONCE = 64;

} // namespace

void *HullPairs::allocateCollisionAlgorithm(int) {
    throw std::logic_error("Bullet finds a contact where Pluvia does");
}

HullSearch::HullSearch(HullCollision &collision, HullPairs &pairs, Workers &workers)
    : collision_(collision), pairs_(pairs), workers_(workers),
      scratch_(static_cast<std::size_t>(workers.count())) {}

// As Bullet's near callback, for pairs of hulls only: leaves out what cannot
// touch. Every body takes part in every step, so nothing else is asked.
void HullSearch::take(btBroadphasePair &pair) {
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
    const HullBody &body_a = bodies.body(a);
    const HullBody &body_b = bodies.body(b);
    if (algorithm == nullptr) {
        const PairValue &value =
            collision_.materials->of(body_a.object->getUserIndex(), body_b.object->getUserIndex());
        algorithm = new (pairs_.room()) HullAlgorithm(collision_, value, a, b);
        pair.m_algorithm = algorithm;
    }
    work_.push_back({algorithm, &body_a, &body_b, travelled, 0});
}

// Asks the memory for what the pairs after number `i` carry, and then for what
// they will read of the hulls.
void HullSearch::ask_ahead(std::size_t i, std::size_t end) const {
    if (i + AHEAD < end) {
        const Work &work = work_[i + AHEAD];
        prefetch(*work.algorithm);
        __builtin_prefetch(work.a->hull);
        __builtin_prefetch(work.b->hull);
    }
    if (i + AHEAD / 2 < end) {
        const Work &work = work_[i + AHEAD / 2];
        work.algorithm->ask_for_hulls(*work.a->hull, *work.b->hull);
    }
}

void HullSearch::find(btOverlappingPairCache &pairs) {
    work_.clear();
    btBroadphasePair *const first = pairs.getOverlappingPairArrayPtr();
    const int count = pairs.getNumOverlappingPairs();
    for (int i = 0; i < count; ++i) {
        __builtin_prefetch(first[std::min(i + FAR_AHEAD, count - 1)].m_algorithm);
        take(first[i]);
    }
    workers_.share(work_.size(), PAIRS_AT_ONCE,
                   [this](int worker, std::size_t begin, std::size_t end) {
                       PairScratch &scratch = scratch_[static_cast<std::size_t>(worker)];
                       for (std::size_t i = begin; i < end; ++i) {
                           ask_ahead(i, end);
                           Work &work = work_[i];
                           work.algorithm->find(*work.a, *work.b, work.travelled, scratch);
                           work.points = work.algorithm->points();
                       }
                   });
    for (const Work &work : work_) {
        if (work.points > 0) {
            collision_.touching.push_back({&work.algorithm->state(), work.a, work.b, work.points});
        }
    }
}

} // namespace pluvia
