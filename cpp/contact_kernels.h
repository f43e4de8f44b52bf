// The arithmetic of the solver on contacts beside each other. See
// contact_iterations.h for what it computes.
#pragma once

#include "contact_batches.h"

#include <vector>

namespace pluvia {

#define PLUVIA_INLINE inline __attribute__((always_inline))

// The law with its lengths of time, in the precision of the lanes.
template <class N> struct LaneLaw {
    N step, inverse_step; // of a sub-step
    N push_out_speed, restitution_speed, closed_gap;
    N unsolved_speed; // approach that calls for another sweep
};

// Where a blow calls for more sweeps, at most so many times as many.
constexpr int MOST_SWEEPS = 8;

// What contacts ask of the bodies of one side of a batch.
template <class L> struct Side {
    Three<L> velocity, spin;
    L inverse_mass;
    Symmetric<L> inertia;
};

template <class L> using Bodies = PackedBody<typename Lane<L>::Number>;

template <class L>
PLUVIA_INLINE void gather_motion(const Bodies<L> *bodies, const int *index, Side<L> &side) {
    L f[8];
    gather(bodies, 0, index, f);
    side.velocity = {f[0], f[1], f[2]};
    side.inverse_mass = f[3];
    side.spin = {f[4], f[5], f[6]};
}

template <class L>
PLUVIA_INLINE void gather_all(const Bodies<L> *bodies, const int *index, Side<L> &side) {
    gather_motion(bodies, index, side);
    L f[8];
    gather(bodies, 8, index, f);
    side.inertia = {f[0], f[1], f[2], f[3], f[4], f[5]};
}

// What does not move may stand in several lanes; all write what was there.
template <class L>
PLUVIA_INLINE void scatter_motion(const Side<L> &side, const int *index, Bodies<L> *bodies) {
    const L f[8] = {side.velocity.x, side.velocity.y, side.velocity.z, side.inverse_mass,
                    side.spin.x,     side.spin.y,     side.spin.z,     L{}};
    scatter(f, index, bodies, 0);
}

template <class L>
PLUVIA_INLINE void push(Side<L> &a, Side<L> &b, const Batch<L> &c, const Three<L> &impulse) {
    a.velocity = a.velocity + impulse * a.inverse_mass;
    a.spin = a.spin + a.inertia * c.arm_a.cross(impulse);
    b.velocity = b.velocity - impulse * b.inverse_mass;
    b.spin = b.spin - b.inertia * c.arm_b.cross(impulse);
}

template <class L>
PLUVIA_INLINE Three<L> relative(const Side<L> &a, const Side<L> &b, const Batch<L> &c) {
    return a.velocity + a.spin.cross(c.arm_a) - b.velocity - b.spin.cross(c.arm_b);
}

// Keeps quotients of nothing by nothing defined.
template <class L>
inline constexpr typename Lane<L>::Number TINY = static_cast<typename Lane<L>::Number>(1e-30);

// Relative speed along e per unit of impulse along d.
template <class L>
PLUVIA_INLINE L compliance(const Batch<L> &c, const Side<L> &a, const Side<L> &b, const Three<L> &d,
                           const Three<L> &e) {
    return (a.inverse_mass + b.inverse_mass) * d.dot(e) +
           c.arm_a.cross(d).dot(a.inertia * c.arm_a.cross(e)) +
           c.arm_b.cross(d).dot(b.inertia * c.arm_b.cross(e));
}

// The masses that the bodies show at the arms of the sub-step. With those of
// the step's beginning a body that turns fast, and whose arms have grown, is
// pushed by more than it needs, the more so in every sweep.
//
// One mass for all directions of the contact plane, that of the direction that
// resists sliding least: friction of a sliding contact then points against its
// speed. With the inverse of the 2 x 2 matrix it would point elsewhere at every
// corner of a body, and the parts that cancel out would use up the cone (a
// block that slides along its edges was found to lose 8 % of its friction).
template <class L> PLUVIA_INLINE void set_masses(Batch<L> &c, const Side<L> &a, const Side<L> &b) {
    const L zero{};
    const L one = zero + 1;
    const L half = zero + typename Lane<L>::Number(0.5);
    const auto filled = c.mass > zero; // what pads a batch has no mass
    const L normal = compliance(c, a, b, c.normal, c.normal);
    const L k11 = compliance(c, a, b, c.tangent_1, c.tangent_1);
    const L k22 = compliance(c, a, b, c.tangent_2, c.tangent_2);
    const L k12 = compliance(c, a, b, c.tangent_1, c.tangent_2);
    const L apart = (k11 - k22) * half;
    const L softest = (k11 + k22) * half + root(L(apart * apart + k12 * k12));
    c.mass = filled ? L(one / (filled ? normal : one)) : zero;
    c.spring_mass = filled ? L(one / (filled ? L(normal + c.spring_yield) : one)) : zero;
    c.tangent_mass = filled ? L(one / (filled ? softest : one)) : zero;
}

// A vector turned by a rotation vector, to the second order.
template <class L> PLUVIA_INLINE Three<L> turned(const Three<L> &arm, const Three<L> &by) {
    const Three<L> first = by.cross(arm);
    const L half = L{} + typename Lane<L>::Number(0.5);
    return arm + first + by.cross(first) * half;
}

// The speed to reach along the normal in this sub-step, and how the contact
// yields.
//
// A contact that is not closed yet is met exactly at the end of the sub-step.
// One that closes and came with a speed worth mentioning leaves with the
// coefficient of restitution times that speed, which was remembered from when
// it was still free. Everything else is an implicit spring and damper (Catto
// 2011, "Soft constraints"). Velocities are those before gravity.
template <class L>
PLUVIA_INLINE void aim(Batch<L> &c, const LaneLaw<typename Lane<L>::Number> &law,
                       const Bodies<L> *bodies) {
    const L zero{};
    Side<L> a, b;
    gather_all(bodies, c.a, a);
    gather_all(bodies, c.b, b);
    L f[8], g[8];
    gather(bodies, 16, c.a, f);
    gather(bodies, 16, c.b, g);
    const Three<L> moved_a{f[0], f[1], f[2]}, turned_a{f[4], f[5], f[6]};
    const Three<L> moved_b{g[0], g[1], g[2]}, turned_b{g[4], g[5], g[6]};
    const Three<L> turned_arm_a = turned(c.first_arm_a, turned_a);
    const Three<L> turned_arm_b = turned(c.first_arm_b, turned_b);
    const Three<L> way =
        moved_a - moved_b + (turned_arm_a - c.first_arm_a) - (turned_arm_b - c.first_arm_b);
    const L gap = c.gap + way.dot(c.normal);
    // Both bodies are pushed in one point, nearer to the lighter one's: so the
    // angular momentum is kept, however far they slid past each other, and a
    // block stays on its corners wherever on the plane it is.
    const Three<L> apart = c.normal * c.gap + way;
    const L both = larger(L(a.inverse_mass + b.inverse_mass), L(zero + TINY<L>));
    c.arm_a = turned_arm_a - apart * L(b.inverse_mass / both);
    c.arm_b = turned_arm_b + apart * L(a.inverse_mass / both);
    set_masses(c, a, b);
    const L arrival = larger(c.arrival, L(zero - relative(a, b, c).dot(c.normal)));

    const auto closed = gap <= zero + law.closed_gap;
    const auto rebounds =
        closed & (arrival > zero + law.restitution_speed) & (c.restitution > zero);
    const L spring =
        smaller(L(zero - c.share * gap * law.inverse_step), L(zero + law.push_out_speed));
    c.target = closed ? (rebounds ? L(c.restitution * arrival) : spring)
                      : L(zero - gap * law.inverse_step);
    const auto springs = closed & !rebounds;
    c.normal_mass = springs ? c.spring_mass : c.mass;
    c.yield = springs ? c.spring_yield : zero;
    // The blow of a rebound says nothing about the force that follows.
    const auto struck = c.struck > zero;
    c.impulse = struck ? zero : c.impulse;
    c.impulse_1 = struck ? zero : c.impulse_1;
    c.impulse_2 = struck ? zero : c.impulse_2;
    c.struck = rebounds ? L(zero + 1) : zero;
    c.arrival = closed ? zero : arrival;
}

// Friction first, within the cone that the normal impulse allows so far; the
// normal last, since overlap is worse than a little sliding. `unsolved` gets the
// fastest approach found, beyond what the contacts aim at.
template <class L> PLUVIA_INLINE void solve(Batch<L> &c, Side<L> &a, Side<L> &b, L &unsolved) {
    const L zero{};
    Three<L> speed = relative(a, b, c);
    L next_1 = c.impulse_1 - c.tangent_mass * speed.dot(c.tangent_1);
    L next_2 = c.impulse_2 - c.tangent_mass * speed.dot(c.tangent_2);
    const L most = c.friction * c.impulse;
    const L size = root(L(next_1 * next_1 + next_2 * next_2));
    // min(1, most/size), for size 0 as well.
    const L scale = most / larger(L(most), larger(size, L(zero + TINY<L>)));
    next_1 = next_1 * scale;
    next_2 = next_2 * scale;
    push(a, b, c, c.tangent_1 * L(next_1 - c.impulse_1) + c.tangent_2 * L(next_2 - c.impulse_2));
    c.impulse_1 = next_1;
    c.impulse_2 = next_2;

    speed = relative(a, b, c);
    const L error = speed.dot(c.normal) - c.target + c.yield * c.impulse;
    unsolved = larger(unsolved, L(zero - error));
    const L next = larger(zero, L(c.impulse - c.normal_mass * error));
    push(a, b, c, c.normal * L(next - c.impulse));
    c.impulse = next;
}

template <class L> PLUVIA_INLINE bool any_larger(const L &lanes, typename Lane<L>::Number least) {
    bool any = false;
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        any = any || Lane<L>::get(lanes, i) > least;
    }
    return any;
}

// One sub-step: external forces, the impulses with which it begins, the
// sweeps, and the way the bodies go.
template <class L>
PLUVIA_INLINE void substep(std::vector<Batch<L>> &batches, int sweeps,
                           const LaneLaw<typename Lane<L>::Number> &law,
                           std::vector<Bodies<L>> &bodies) {
    auto *const body = bodies.data();
    Side<L> a, b;
    for (Batch<L> &c : batches) {
        aim(c, law, body);
    }
    for (auto &x : bodies) {
        for (int i = 0; i < 8; ++i) {
            x.motion[i] += x.forced[i];
        }
    }
    for (Batch<L> &c : batches) {
        gather_all(body, c.a, a);
        gather_all(body, c.b, b);
        push(a, b, c, c.normal * c.impulse + c.tangent_1 * c.impulse_1 + c.tangent_2 * c.impulse_2);
        scatter_motion(a, c.a, body);
        scatter_motion(b, c.b, body);
    }
    // A blow to a heap takes more sweeps to get through it than its weight.
    for (int i = 0; i < MOST_SWEEPS * sweeps; ++i) {
        L unsolved{};
        for (Batch<L> &c : batches) {
            gather_all(body, c.a, a);
            gather_all(body, c.b, b);
            solve(c, a, b, unsolved);
            scatter_motion(a, c.a, body);
            scatter_motion(b, c.b, body);
        }
        if (i + 1 >= sweeps && !any_larger(unsolved, law.unsolved_speed)) {
            break;
        }
    }
    for (Batch<L> &c : batches) {
        c.total = c.total + c.impulse;
        c.total_1 = c.total_1 + c.impulse_1;
        c.total_2 = c.total_2 + c.impulse_2;
    }
    for (auto &x : bodies) {
        for (int i = 0; i < 8; ++i) {
            x.way[i] += x.motion[i] * law.step;
        }
    }
}

} // namespace pluvia
