// One visit to a pack of pairs, of which iterations are made.
//
// An iteration visits all pairs colour by colour, and then all of them in the reverse
// order of the colours: projected Gauss-Seidel, symmetric. It is accelerated after Nesterov:
// every iteration begins beyond where the last one ended, along the way that it and the one
// before took together, and begins anew where that made things worse (Mazhar, Heyn, Negrut &
// Tasora 2015, "Using Nesterov's method to accelerate multibody dynamics with friction and
// contact"; O'Donoghue & Candès 2015, "Adaptive restart for accelerated gradient schemes").
// There and back, because acceleration wants a symmetric preconditioner.
#pragma once

#include "contact_kernels.h"

namespace pluvia {

// When contacts are solved. `Forces`: hardly any is approached faster than it aims at,
// which is what adds overlap, and the last iteration changed no body by more than a little
// of what contacts change of a body in the sub-step. The worst body counts, not all together:
// where one grain among thousands lags behind the forces on it, it swings, and is never at
// rest. Bodies count, not impulses: where several points hold a body, impulses may wander
// among them while nothing moves. `Impacts`: the last iteration changed no body's velocity
// by more than half of what is asked for.
enum class Solved { Forces, Impacts };

// Which half of an iteration.
enum class Half { There, Back };

// What an iteration left to be done.
template <class L> struct alignas(64) Unsolved {
    L speed{};   // the fastest approach beyond what is aimed at, or change of speed of impacts
    L work{};    // what it changed, as an energy: impulses squared over the mass they move
    L fastest{}; // approach of impacts
};

// Solves one point of each pair. Friction first, within the cone that the normal
// impulse allows so far; the normal last, since overlap is worse than a little sliding.
//
// On the way there it first goes on along its way, `beta` times as far as the last
// iteration went. It remembers what the iteration changes beyond that.
template <Solved WHAT, Half HALF, class L>
PLUVIA_INLINE void solve(const Pack<L> &pack, Point<L> &c, Search<L> &search, const L &beta,
                         Sides<L> &at, Unsolved<L> &unsolved) {
    const L zero{};
    if (HALF == Half::There) {
        search.extrapolation = (search.extrapolation + search.change) * beta;
        search.extrapolation_1 = (search.extrapolation_1 + search.change_1) * beta;
        search.extrapolation_2 = (search.extrapolation_2 + search.change_2) * beta;
        search.change = search.change_1 = search.change_2 = zero;
        c.impulse = c.impulse + search.extrapolation;
        c.impulse_1 = c.impulse_1 + search.extrapolation_1;
        c.impulse_2 = c.impulse_2 + search.extrapolation_2;
    }
    const L slip_1 = parting(at.a, at.b, pack.tangent_1, c.angular_1_a, c.angular_1_b);
    const L slip_2 = parting(at.a, at.b, pack.tangent_2, c.angular_2_a, c.angular_2_b);
    L next_1 = c.impulse_1 - c.tangent_mass * slip_1;
    L next_2 = c.impulse_2 - c.tangent_mass * slip_2;
    const L most = pack.friction * larger(zero, c.impulse);
    const L size = root(L(next_1 * next_1 + next_2 * next_2));
    // min(1, most/size), for size 0 as well.
    const L scale = most / larger(L(most), larger(size, L(zero + TINY<L>)));
    next_1 = next_1 * scale;
    next_2 = next_2 * scale;
    const L more_1 = next_1 - c.impulse_1;
    const L more_2 = next_2 - c.impulse_2;
    c.impulse_1 = next_1;
    c.impulse_2 = next_2;

    const L speed = parting(at.a, at.b, pack.normal, c.angular_a, c.angular_b) +
                    (c.coupling_1 * more_1 + c.coupling_2 * more_2);
    const L error = speed - c.bias + c.softness * c.impulse;
    const L wanted = larger(zero, L(c.impulse - c.normal_mass * error));
    const L next = smaller(wanted, c.most);
    const L more = next - c.impulse;
    if (HALF == Half::Back) {
        const L by_normal = more / larger(c.normal_mass, L(zero + TINY<L>));
        const L turn = more_1 * more_1 + more_2 * more_2;
        const L mass = larger(c.tangent_mass, L(zero + TINY<L>));
        unsolved.work = unsolved.work + (more * by_normal + turn / mass);
        if (WHAT == Solved::Impacts) {
            unsolved.speed = larger(unsolved.speed, larger(by_normal, L(zero - by_normal)));
            unsolved.speed = larger(unsolved.speed, L(root(turn) / mass));
        } else {
            unsolved.speed = larger(unsolved.speed, wanted > next ? zero : L(zero - error));
        }
    }
    push(at.a, at.b, pack.normal * more + pack.tangent_1 * more_1 + pack.tangent_2 * more_2,
         c.angular_a * more + c.angular_1_a * more_1 + c.angular_2_a * more_2,
         c.angular_b * more + c.angular_1_b * more_1 + c.angular_2_b * more_2);
    c.impulse = next;
    search.change = search.change + more;
    search.change_1 = search.change_1 + more_1;
    search.change_2 = search.change_2 + more_2;
}

// All points of a pack, one after the other.
template <Solved WHAT, Half HALF, class L>
PLUVIA_INLINE void visit(const Pack<L> &pack, Point<L> *points, Search<L> *search, const L &beta,
                         Records<L> *motion, Unsolved<L> &unsolved) {
    Sides<L> at(pack, motion);
    for (int p = 0; p < pack.points; ++p) {
        solve<WHAT, HALF>(pack, points[p], search[p], beta, at, unsolved);
    }
    at.put_back(pack, motion);
}

template <class L> PLUVIA_INLINE double sum(const L &lanes) {
    double all = 0;
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        all += static_cast<double>(Lane<L>::get(lanes, i));
    }
    return all;
}

} // namespace pluvia
