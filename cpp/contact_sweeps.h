// Sweeps over the contacts of a sub-step, until it is solved.
//
// A round is a sweep of projected Gauss-Seidel there and one back. Every round goes on
// along the way that those before took together: nonsmooth nonlinear conjugate
// gradients (Silcowitz-Hansen, Niebe & Erleben 2010, "A nonsmooth nonlinear conjugate
// gradient method for interactive contact force problems"). There and back, because
// conjugate gradients want a symmetric preconditioner.
#pragma once

#include "contact_kernels.h"

namespace pluvia {

// Most rounds in a sub-step, unless more are asked for.
constexpr int MOST_ROUNDS = 256;

// Among few contacts there are more rounds than asked for, until this number of batches
// has been solved or there were so many rounds: they cost nothing, and without them a
// single block is half a percent of its way off after it has slid.
constexpr int SMALL_WORK = 512;
constexpr int SMALL_ROUNDS = 32;

// Most rounds for impacts among few contacts: a block that meets two supports needs hundreds.
constexpr int SMALL_IMPACT_WORK = 4096;

// When contacts are solved. `Forces`: hardly any is approached faster than it
// aims at, which is what adds overlap, and the last round changed none by more than a
// little of what contacts change of a body in the sub-step. The worst contact counts, not
// all together: where one grain among thousands lags behind the forces on it, it swings,
// and is never at rest. `Impacts`: no speed changed by much, of sliding neither.
enum class Solved { Forces, Impacts };

// Which sweep of a round.
enum class Way { There, Back };

// What a round left to be done.
template <class L> struct Unsolved {
    L speed{}; // the fastest of what is asked for
    L work{};  // what it changed, as an energy: impulses squared over the mass they move
    L most{};  // the same of the contact that a sweep changed most
};

// Solves the contacts of a batch. Friction first, within the cone that the normal
// impulse allows so far; the normal last, since overlap is worse than a little sliding.
//
// On the way there the batch first goes on along its way, `beta` times as far as before.
// It remembers what the round changes beyond that.
template <Solved WHAT, Way WAY, class L>
PLUVIA_INLINE void solve(Batch<L> &c, Search<L> &search, const L &beta, Side<L> &a, Side<L> &b,
                         Unsolved<L> &unsolved) {
    const L zero{};
    if (WAY == Way::There) {
        const L on = search.way * beta, on_1 = search.way_1 * beta, on_2 = search.way_2 * beta;
        search.way = on + search.change;
        search.way_1 = on_1 + search.change_1;
        search.way_2 = on_2 + search.change_2;
        search.change = search.change_1 = search.change_2 = zero;
        c.impulse = c.impulse + on;
        c.impulse_1 = c.impulse_1 + on_1;
        c.impulse_2 = c.impulse_2 + on_2;
    }
    const L slip_1 = parting(a, b, c.tangent_1, c.lever_1_a, c.lever_1_b);
    const L slip_2 = parting(a, b, c.tangent_2, c.lever_2_a, c.lever_2_b);
    L next_1 = c.impulse_1 - c.tangent_mass * slip_1;
    L next_2 = c.impulse_2 - c.tangent_mass * slip_2;
    const L most = c.friction * larger(zero, c.impulse);
    const L size = root(L(next_1 * next_1 + next_2 * next_2));
    // min(1, most/size), for size 0 as well.
    const L scale = most / larger(L(most), larger(size, L(zero + TINY<L>)));
    next_1 = next_1 * scale;
    next_2 = next_2 * scale;
    const L more_1 = next_1 - c.impulse_1;
    const L more_2 = next_2 - c.impulse_2;
    push(a, b, c.tangent_1 * more_1 + c.tangent_2 * more_2,
         c.lever_1_a * more_1 + c.lever_2_a * more_2, c.lever_1_b * more_1 + c.lever_2_b * more_2);
    c.impulse_1 = next_1;
    c.impulse_2 = next_2;

    const L speed = parting(a, b, c.normal, c.lever_a, c.lever_b);
    const L error = speed - c.target + c.yield * c.impulse;
    const L wanted = larger(zero, L(c.impulse - c.normal_mass * error));
    const L next = smaller(wanted, c.most);
    const L more = next - c.impulse;
    if (WAY == Way::Back) {
        const L by_normal = more / larger(c.normal_mass, L(zero + TINY<L>));
        const L turn = more_1 * more_1 + more_2 * more_2;
        const L mass = larger(c.tangent_mass, L(zero + TINY<L>));
        const L work = more * by_normal + turn / mass;
        unsolved.work = unsolved.work + work;
        if (WHAT == Solved::Impacts) {
            unsolved.speed = larger(unsolved.speed, larger(by_normal, L(zero - by_normal)));
            unsolved.speed = larger(unsolved.speed, L(root(turn) / mass));
        } else {
            unsolved.most = larger(unsolved.most, work);
            unsolved.speed = larger(unsolved.speed, wanted > next ? zero : L(zero - error));
        }
    }
    push(a, b, c.normal * more, c.lever_a * more, c.lever_b * more);
    c.impulse = next;
    search.change = search.change + more;
    search.change_1 = search.change_1 + more_1;
    search.change_2 = search.change_2 + more_2;
}

template <Solved WHAT, Way WAY, class L>
PLUVIA_INLINE void solve_at(Batch<L> &c, Search<L> &search, const L &beta, Records<L> *motion,
                            Unsolved<L> &unsolved) {
    Side<L> a, b;
    gather_motion(motion, c.a, a);
    gather_motion(motion, c.b, b);
    solve<WHAT, WAY>(c, search, beta, a, b, unsolved);
    scatter_motion(a, c.a, motion);
    scatter_motion(b, c.b, motion);
}

template <class L> PLUVIA_INLINE double sum(const L &lanes) {
    double all = 0;
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        all += static_cast<double>(Lane<L>::get(lanes, i));
    }
    return all;
}

// The bodies' part of going on along the way; `before` is the motion before the last round.
template <class N> PLUVIA_INLINE void go_on(PackedBodies<N> &bodies, N beta) {
    for (std::size_t b = 0; b < bodies.motion.size(); ++b) {
        for (int i = 0; i < 8; ++i) {
            N &now = bodies.motion[b].at[i];
            N &way = bodies.search[b].at[i];
            N &before = bodies.before[b].at[i];
            const N on = way * beta;
            way = on + (now - before);
            now += on;
            before = now;
        }
    }
}

// What contacts have changed in the sub-step, as an energy: the mean of the bodies that
// they have changed.
template <class N> PLUVIA_INLINE double changed(const PackedBodies<N> &bodies) {
    double all = 0;
    int count = 0;
    for (std::size_t b = 0; b < bodies.motion.size(); ++b) {
        const auto &m = bodies.motion[b].at;
        const auto &f = bodies.free[b].at;
        N shift = 0, turn = 0;
        for (int i = 0; i < 3; ++i) {
            shift += (m[i] - f[i]) * (m[i] - f[i]);
            turn += (m[i + 4] - f[i + 4]) * (m[i + 4] - f[i + 4]);
        }
        const double one = m[3] > 0 ? static_cast<double>(shift / m[3] + turn) : 0;
        all += one;
        count += one > 0 ? 1 : 0;
    }
    return count > 0 ? all / count : 0;
}

// Goes over the contacts that are awake until they are solved: until less than
// `limit` of speed is unsolved, and no contact's change is more than the square of
// `share` of what contacts change of a body. `sweeps`: how many there are at least.
//
// A contact that bears nothing and is not approached too fast is left as it is
// by a sweep. So the contacts that are not near are looked at in the first
// round, every so many, and when all others are solved; they take part in all
// rounds from when one of their batch bears something.
template <Solved WHAT, class L>
PLUVIA_INLINE void iterate(Contacts<L> &contacts, int sweeps, typename Lane<L>::Number limit,
                           double share, Bodies<L> &bodies) {
    using N = typename Lane<L>::Number;
    auto &batches = contacts.batches;
    auto *const motion = bodies.motion.data();
    const int count = std::max(1, static_cast<int>(batches.size()));
    const bool impacts = WHAT == Solved::Impacts;
    const int least =
        std::max((sweeps + 1) / 2, impacts ? 0 : std::min(SMALL_ROUNDS, SMALL_WORK / count));
    const int most = std::max({MOST_ROUNDS, least, impacts ? SMALL_IMPACT_WORK / count : 0});
    contacts.search.assign(batches.size(), Search<L>{});
    bodies.begin_search();
    double work = 0;
    N beta = 0;
    for (int round = 1; round <= most; ++round) {
        Unsolved<L> unsolved;
        if (round > 1) {
            go_on(bodies, beta);
        }
        const L lanes = L{} + beta;
        for (std::size_t i = 0; i < batches.size(); ++i) {
            if (contacts.awake[i]) {
                solve_at<WHAT, Way::There>(batches[i], contacts.search[i], lanes, motion, unsolved);
            }
        }
        for (std::size_t i = batches.size(); i-- > 0;) {
            if (contacts.awake[i]) {
                solve_at<WHAT, Way::Back>(batches[i], contacts.search[i], lanes, motion, unsolved);
            }
        }
        const auto is_solved = [&]() __attribute__((always_inline)) {
            return round >= least && !any_larger(unsolved.speed, limit) &&
                   (WHAT == Solved::Impacts ||
                    !any_larger(unsolved.most, static_cast<N>(share * share * changed(bodies))));
        };
        const bool solved = is_solved();
        if (round == 1 || round % least == 0 || solved) {
            for (std::size_t i = contacts.near; i < batches.size(); ++i) {
                if (!contacts.awake[i]) {
                    solve_at<WHAT, Way::Back>(batches[i], contacts.search[i], lanes, motion,
                                              unsolved);
                    contacts.awake[i] = any_larger(batches[i].impulse, 0);
                }
            }
            if (solved && is_solved()) {
                break;
            }
        }
        const double left = sum(unsolved.work);
        beta = work > 0 && left < work ? static_cast<N>(left / work) : 0;
        work = left;
    }
}

} // namespace pluvia
