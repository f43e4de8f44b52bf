// Phases that follow each other without the control looking in between, by all threads.
#pragma once

#include "contact_load.h"
#include "workers.h"

#include <algorithm>
#include <vector>

namespace pluvia {

// Packs and bodies that a thread takes at least: fewer do not pay for the others' coming.
constexpr std::size_t PACKS_AT_ONCE = 8;
constexpr std::size_t FEW_PACKS_AT_ONCE = 32; // of the pairs of few bodies (contact_few.h)
constexpr std::size_t BODIES_AT_ONCE = 512;

template <class L> class Sequence {
  public:
    explicit Sequence(Problem<L> &problem) : p_(problem) {}

    // Over listed packs or bodies.
    void packs(Phase phase, const std::vector<int> &list) {
        add(phase, list.data(), list.size(), list.size(), PACKS_AT_ONCE);
    }
    void bodies(Phase phase, const std::vector<int> &list) {
        add(phase, list.data(), list.size(), list.size(), BODIES_AT_ONCE);
    }
    // Over all packs, each by the thread at which it is at home.
    void packs(Phase phase) {
        chained_ = false;
        const Homes &homes = p_.contacts->homes;
        add_at_home(phase, homes.order().data(), homes.order().size(), homes.ends(), Share::ALL);
    }
    void bodies(Phase phase) {
        const std::size_t all = p_.bodies.motion.size();
        add(phase, nullptr, all, all, BODIES_AT_ONCE);
    }

    // Over packs, one colour after the other; `back`: from the last to the first.
    void colours(Phase phase, const Turn &turn, bool back) {
        const Colours &colours = p_.contacts->colours;
        const std::size_t count = turn.begin.size() - 1;
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t c = back ? count - 1 - k : k;
            const auto size = static_cast<std::size_t>(turn.begin[c + 1] - turn.begin[c]);
            const int *const packs = turn.packs.data() + turn.begin[c];
            if (turn.ends.empty() || colours.in_order(c)) {
                add(phase, packs, size, size, colours.in_order(c) ? size : FEW_PACKS_AT_ONCE);
                continue;
            }
            const auto threads = static_cast<std::size_t>(p_.contacts->workers.count());
            const std::size_t *const ends = turn.ends.data() + 2 * threads * c;
            const std::size_t between = ends[threads - 1];
            if (!chained_) {
                first_ = shares_.size();
                next_ = first_;
            }
            add_at_home(phase, packs, between, ends, next_);
            next_ = between > 0 ? shares_.size() : next_;
            add_at_home(phase, packs + between, size - between, ends + threads, first_);
            chained_ = true;
        }
    }

    // Over blocks of the listed bodies.
    void change(Phase phase, const std::vector<int> &bodies) {
        const std::size_t blocks = (bodies.size() + BODY_BLOCK - 1) / BODY_BLOCK;
        p_.changes.resize(blocks);
        add(phase, bodies.data(), bodies.size(), blocks, BODIES_AT_ONCE / BODY_BLOCK);
    }

    // Does all of it; then there is nothing left to do.
    void run() {
        p_.contacts->workers.share(
            shares_.data(), shares_.size(),
            [this](std::size_t k, int worker, std::size_t begin, std::size_t end) {
                const Step &step = steps_[k];
                p_.kernel(step.phase, p_, {step.list, step.listed, worker, begin, end});
            });
        forget();
    }

    // Does none of it.
    void forget() {
        steps_.clear();
        shares_.clear();
        chained_ = false;
    }

  private:
    struct Step {
        Phase phase;
        const int *list;
        std::size_t listed;
    };
    Problem<L> &p_;
    std::vector<Step> steps_;
    std::vector<Share> shares_;
    // Colours that follow each other: which share is their first, and of which all must be over
    // before packs between threads come to the next.
    bool chained_ = false;
    std::size_t first_ = 0, next_ = 0;

    // Warm start, forwards, backwards, and what comes between.
    static_assert(6 * Colours::MOST + 7 <= Workers::MOST_SHARES);

    // `listed` are in the list, `size` things are done; `least` of them a thread takes.
    void add(Phase phase, const int *list, std::size_t listed, std::size_t size,
             std::size_t least) {
        if (size > 0) {
            const auto threads = static_cast<std::size_t>(p_.contacts->workers.count());
            least = size < 2 * least ? size : least;
            steps_.push_back({phase, list, listed});
            shares_.push_back({size, std::max(least, (size + threads - 1) / threads), least});
            chained_ = false;
        }
    }

    // Those that every thread has at home, in one part.
    void add_at_home(Phase phase, const int *list, std::size_t size, const std::size_t *ends,
                     std::size_t after) {
        if (size > 0) {
            steps_.push_back({phase, list, size});
            shares_.push_back({size, size, PACKS_AT_ONCE / 2, ends, after});
        }
    }
};

} // namespace pluvia
