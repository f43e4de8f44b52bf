// The pairs of few bodies, copied to be iterated by themselves.
#pragma once

#include "contact_sequence.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace pluvia {

template <class L> class Few {
  public:
    explicit Few(Problem<L> &problem) : p_(problem) {}

    // To be called when a step begins.
    void begin() { ends_.clear(); }

    // Copies the pairs that active bodies have in packs that are awake, colour by
    // colour, and lists the bodies of these pairs.
    void choose() {
        mark();
        from_.clear();
        turn_.packs.clear();
        turn_.begin.assign(1, 0);
        bodies_.clear();
        start_.clear();
        listed_.assign(p_.bodies.motion.size(), 0);
        plans_.clear();
        int points = 0;
        const Colours &colours = p_.contacts->colours;
        for (std::size_t c = 0; c < colours.count(); ++c) {
            const int width = colours.in_order(c) ? 1 : Lane<L>::WIDTH;
            bool full = true;
            for (int i = colours.begin()[c]; i < colours.begin()[c + 1]; ++i) {
                const auto number = static_cast<std::size_t>(i);
                const Pack<L> &pack = p_.all.packs[number];
                for (unsigned left = taken_[number]; left != 0; left &= left - 1) {
                    const int n = __builtin_ctz(left);
                    if (full) {
                        turn_.packs.push_back(static_cast<int>(plans_.size()));
                        plans_.push_back({static_cast<int>(from_.size()), 0, 0, points, true});
                    }
                    from_.push_back({i, n});
                    Colours::Pack &plan = plans_.back();
                    const int own = points_of(pack.pair[n]);
                    points += std::max(0, own - plan.points);
                    plan.points = std::max(plan.points, own);
                    full = ++plan.pairs == width;
                    list(pack.a[n]);
                    list(pack.b[n]);
                }
            }
            turn_.begin.push_back(static_cast<int>(turn_.packs.size()));
        }
        p_.few.resize(plans_.size(), static_cast<std::size_t>(points));
        p_.contacts->workers.each(plans_.size(), PACKS_AT_ONCE, [&](std::size_t i) { copy(i); });
    }

    // Puts their impulses back.
    void put_back() {
        p_.contacts->workers.each(plans_.size(), PACKS_AT_ONCE, [&](std::size_t i) {
            const int first = plans_[i].first;
            lanes(i, [&](int lane, std::size_t number, int to_lane) {
                const Pack<L> &pack = p_.all.packs[number];
                for (int p = 0; p < points_of(pack.pair[to_lane]); ++p) {
                    const Point<L> &from = p_.few.points[first + p];
                    Point<L> &to = p_.all.points[pack.first + p];
                    copy_lanes(&from.impulse.x, lane, &to.impulse.x, to_lane, 3);
                }
            });
        });
    }

    // Makes those active that were not solved, and those beside them that have changed by more
    // than `limit` since they were chosen, as an energy or for impacts the square of a speed: all
    // other bodies are as they were. False where there are none.
    bool spread(bool impacts, double limit) {
        bool any = false;
        for (std::size_t k = 0; k < bodies_.size(); ++k) {
            const auto b = static_cast<std::size_t>(bodies_[k]);
            if (listed_[b] == BESIDE) {
                const auto &now = p_.bodies.motion[b];
                const auto moved = energy(now, start_[k]) * (impacts ? p_.bodies.root[b].at[6] : 1);
                p_.active[b] = static_cast<double>(moved) > limit;
            }
            any = any || p_.active[b] != 0;
        }
        return any;
    }

    const Turn &turn() const { return turn_; }
    const std::vector<int> &bodies() const { return bodies_; }

  private:
    // Where a pair comes from.
    struct From {
        int pack, lane;
    };

    Problem<L> &p_;
    Turn turn_;
    std::vector<int> bodies_;
    std::vector<From> from_;
    std::vector<Colours::Pack> plans_;                    // that they are put into
    std::vector<Record<typename Lane<L>::Number>> start_; // motion of each when it was chosen
    static constexpr std::uint8_t CHOSEN = 2, BESIDE = 1;
    std::vector<std::uint8_t> listed_; // by body: whether it was active, or has a pair with one

    // By body: where its pairs end in at_, or nothing before they are listed; 8 times pack plus
    // lane.
    std::vector<int> ends_, at_;
    std::vector<std::uint8_t> taken_; // by pack: a bit for each lane whose pair is copied
    static_assert(Lane<L>::WIDTH <= 8);

    // Lists the pairs of every body.
    void list_pairs() {
        const auto packs = p_.all.packs.size();
        const auto each = [&](const auto &what) {
            for (std::size_t i = 0; i < packs; ++i) {
                const Pack<L> &pack = p_.all.packs[i];
                for (int n = 0; n < Lane<L>::WIDTH && pack.pair[n] >= 0; ++n) {
                    for (const int body : {pack.a[n], pack.b[n]}) {
                        if (!p_.contacts->moves.still(body)) {
                            what(static_cast<std::size_t>(body), static_cast<int>(8 * i) + n);
                        }
                    }
                }
            }
        };
        ends_.assign(static_cast<std::size_t>(p_.contacts->moves.all) + 2, 0);
        each([&](std::size_t body, int) { ++ends_[body + 1]; });
        std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
        at_.resize(static_cast<std::size_t>(ends_.back()));
        // What was a body's beginning becomes its end.
        each([&](std::size_t body, int at) { at_[ends_[body]++] = at; });
    }

    // Marks the pairs of active bodies in the packs that are awake.
    void mark() {
        if (ends_.empty()) {
            list_pairs();
        }
        taken_.assign(p_.all.packs.size(), 0);
        for (std::size_t b = 1; b <= static_cast<std::size_t>(p_.contacts->moves.all); ++b) {
            if (p_.active[b] == 0) {
                continue;
            }
            for (int k = ends_[b - 1]; k < ends_[b]; ++k) {
                const int at = at_[k];
                if (p_.awake[at / 8] != 0) {
                    taken_[at / 8] |= static_cast<std::uint8_t>(1 << at % 8);
                }
            }
        }
    }

    int points_of(int pair) const { return p_.contacts->places[pair].points; }
    void list(int body) {
        std::uint8_t &listed = listed_[body];
        if (!p_.contacts->moves.still(body) && listed == 0) {
            listed = p_.active[body] != 0 ? CHOSEN : BESIDE;
            bodies_.push_back(body);
            start_.push_back(p_.bodies.motion[body]);
        }
    }

    // Calls `what(lane, from pack, from lane)` for the pairs of a pack of the few.
    template <class F> void lanes(std::size_t i, const F &what) const {
        for (int lane = 0; lane < plans_[i].pairs; ++lane) {
            const From &from = from_[plans_[i].begin + lane];
            what(lane, static_cast<std::size_t>(from.pack), from.lane);
        }
    }

    void copy(std::size_t i) {
        Pack<L> &to = p_.few.packs[i];
        clear_pack(to, plans_[i].first, plans_[i].points);
        for (int p = 0; p < to.points; ++p) {
            p_.few.points[to.first + p] = Point<L>{};
        }
        lanes(i, [&](int lane, std::size_t number, int from_lane) {
            const Pack<L> &from = p_.all.packs[number];
            copy_lane(from, from_lane, to, lane);
            for (int p = 0; p < points_of(from.pair[from_lane]); ++p) {
                copy_lane(p_.all.points[from.first + p], from_lane, p_.few.points[to.first + p],
                          lane);
            }
        });
    }
};

} // namespace pluvia
