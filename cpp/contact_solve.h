// One visit to a pack of pairs, of which iterations are made.
//
// An iteration visits all pairs colour by colour, and then all of them in the reverse
// order of the colours: projected Gauss-Seidel, symmetric. It is accelerated after Nesterov:
// every iteration begins beyond where the last one ended, in the direction from where the one
// before ended, and begins anew where that made things worse (Mazhar, Heyn, Negrut &
// Tasora 2015, "Using Nesterov's method to accelerate multibody dynamics with friction and
// contact"; O'Donoghue & Candès 2015, "Adaptive restart for accelerated gradient schemes").
// Forwards and backwards, because acceleration wants a symmetric preconditioner.
#pragma once

#include "contact_kernels.h"

namespace pluvia {

// What is solved. `Forces`: contacts under load and what they meet, until hardly any is approached
// faster than its bias velocity, which is what adds overlap, and bodies hardly change any more
// (see contact_run.h). `Impacts`: the phases in which contacts rebound.
enum class Solved { Forces, Impacts };

// Which half of an iteration.
enum class Half { Forward, Backward };

// What packs have found.
template <class L> struct alignas(64) Unsolved {
    L speed{};   // the fastest approach beyond the bias velocity
    L fastest{}; // approach of impacts
    L borne{};   // the largest normal impulse that a visit would give
};

// Solves one point of each pair. Friction first, within the cone that the normal
// impulse allows so far; the normal last, since overlap is worse than a little sliding.
//
// Forwards, impulses first go on as the last iteration changed them, `beta` times as far.
template <Solved WHAT, Half HALF, class L>
PLUVIA_INLINE void solve(const Pack<L> &pack, Point<L> &c, Search<L> &last, const L &beta,
                         Sides<L> &at, Unsolved<L> &unsolved) {
    const L zero{};
    L borne = c.impulse.x;
    if (HALF == Half::Forward) {
        const auto go_on = [&](L &impulse, L &then) PLUVIA_INLINED {
            const L now = impulse;
            impulse = now + (now - then) * beta;
            then = now;
        };
        go_on(c.impulse.x, last.impulse.x);
        go_on(c.impulse.y, last.impulse.y);
        go_on(c.impulse.z, last.impulse.z);
        borne = larger(zero, c.impulse.x);
    }
    const L slip_1 = parting(at, pack.tangent_1, c.angular_1);
    const L slip_2 = parting(at, pack.tangent_2, c.angular_2);
    L next_1 = c.impulse.y - c.tangent_mass * slip_1;
    L next_2 = c.impulse.z - c.tangent_mass * slip_2;
    const L most = pack.friction * borne;
    const L size = root(L(next_1 * next_1 + next_2 * next_2 + TINY_SQUARE<L>));
    // min(1, most/size), for size 0 as well.
    const L scale = most / larger(most, size);
    next_1 = next_1 * scale;
    next_2 = next_2 * scale;
    const L more_1 = next_1 - c.impulse.y;
    const L more_2 = next_2 - c.impulse.z;
    c.impulse.y = next_1;
    c.impulse.z = next_2;

    const L speed =
        parting(at, pack.normal, c.angular) + (c.coupling_1 * more_1 + c.coupling_2 * more_2);
    const L error = speed - c.bias + c.softness * c.impulse.x;
    L next = larger(zero, L(c.impulse.x - c.normal_mass * error));
    if (WHAT == Solved::Impacts) {
        next = smaller(next, c.most);
    } else if (HALF == Half::Backward) {
        unsolved.speed = larger(unsolved.speed, L(zero - error));
    }
    const L more = next - c.impulse.x;
    c.impulse.x = next;
    push(at, pack, c, {more, more_1, more_2});
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

// The largest normal impulse that a visit would give to a point of a pack that bears nothing. Where
// it is 0, a visit changes nothing.
template <Solved WHAT, class L>
PLUVIA_INLINE L would_bear(const Pack<L> &pack, const Point<L> *points, const Records<L> *motion) {
    const L zero{};
    const Sides<L> at(pack, motion);
    L most{};
    for (int p = 0; p < pack.points; ++p) {
        const Point<L> &c = points[p];
        const L error = parting(at, pack.normal, c.angular) - c.bias + c.softness * c.impulse.x;
        L next = larger(zero, L(c.impulse.x - c.normal_mass * error));
        if (WHAT == Solved::Impacts) {
            next = smaller(next, c.most);
        }
        most = larger(most, next);
    }
    return most;
}

} // namespace pluvia
