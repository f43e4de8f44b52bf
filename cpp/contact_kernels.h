// The arithmetic of the solver on contacts beside each other. See
// contact_iterations.h for what it computes.
#pragma once

#include "contact_batches.h"

#include <algorithm>
#include <vector>

namespace pluvia {

#define PLUVIA_INLINE inline __attribute__((always_inline))

// The law with its lengths of time, in the precision of the lanes.
template <class N> struct LaneLaw {
    N step, inverse_step; // of a sub-step
    N stiffness,
        damping; // damping per root of mass: twice the ratio times the root of the stiffness
    N push_out_speed, restitution_speed, closed_gap;
    N unsolved_speed;      // approach that calls for another round
    double unsolved_share; // of what contacts change of a body, that calls for another round
};

// The motion of the bodies of one side of a batch.
template <class L> struct Side {
    Three<L> velocity, spin; // the spin times the root of the inertia
    L inverse_mass, turns;
};

template <class L> using Records = Record<typename Lane<L>::Number>;

template <class L> using Bodies = PackedBodies<typename Lane<L>::Number>;

template <class L>
PLUVIA_INLINE void gather_motion(const Records<L> *motion, const int *index, Side<L> &side) {
    L f[8];
    gather(motion, index, f);
    side.velocity = {f[0], f[1], f[2]};
    side.inverse_mass = f[3];
    side.spin = {f[4], f[5], f[6]};
    side.turns = f[7];
}

// What does not move may stand in several lanes; all write what was there.
template <class L>
PLUVIA_INLINE void scatter_motion(const Side<L> &side, const int *index, Records<L> *motion) {
    const L f[8] = {side.velocity.x, side.velocity.y, side.velocity.z, side.inverse_mass,
                    side.spin.x,     side.spin.y,     side.spin.z,     side.turns};
    scatter(f, index, motion);
}

template <class L>
PLUVIA_INLINE void push(Side<L> &a, Side<L> &b, const Three<L> &impulse, const Three<L> &moment_a,
                        const Three<L> &moment_b) {
    a.velocity = a.velocity + impulse * a.inverse_mass;
    a.spin = a.spin + moment_a * a.turns;
    b.velocity = b.velocity - impulse * b.inverse_mass;
    b.spin = b.spin - moment_b * b.turns;
}

// Speed at which the bodies part along a direction with the levers given.
template <class L>
PLUVIA_INLINE L parting(const Side<L> &a, const Side<L> &b, const Three<L> &direction,
                        const Three<L> &lever_a, const Three<L> &lever_b) {
    return (a.velocity - b.velocity).dot(direction) + a.spin.dot(lever_a) - b.spin.dot(lever_b);
}

// Keeps quotients of nothing by nothing defined.
template <class L>
inline constexpr typename Lane<L>::Number TINY = static_cast<typename Lane<L>::Number>(1e-30);

// More than any impulse.
template <class L>
inline constexpr typename Lane<L>::Number UNLIMITED = static_cast<typename Lane<L>::Number>(1e30);

// Levers and masses that the bodies show at the arms of the sub-step. With
// those of the step's beginning a body that turns fast, and whose arms have
// grown, is pushed by more than it needs, the more so in every sweep.
//
// One mass for all directions of the contact plane, that of the direction that
// resists sliding least: friction of a sliding contact then points against its
// speed. With the inverse of the 2 x 2 matrix it would point elsewhere at every
// corner of a body, and the parts that cancel out would use up the cone (a
// block that slides along its edges was found to lose 8 % of its friction).
//
// Returns the mass along the normal.
template <class L>
PLUVIA_INLINE L set_levers(Batch<L> &c, const Side<L> &a, const Side<L> &b, const Three<L> &arm_a,
                           const Three<L> &arm_b, const Bodies<L> &bodies) {
    L f[8], g[8];
    gather(bodies.root.data(), c.a, f);
    gather(bodies.root.data(), c.b, g);
    const Symmetric<L> root_a{f[0], f[1], f[2], f[3], f[4], f[5]};
    const Symmetric<L> root_b{g[0], g[1], g[2], g[3], g[4], g[5]};
    c.lever_a = root_a * arm_a.cross(c.normal);
    c.lever_b = root_b * arm_b.cross(c.normal);
    c.lever_1_a = root_a * arm_a.cross(c.tangent_1);
    c.lever_1_b = root_b * arm_b.cross(c.tangent_1);
    c.lever_2_a = root_a * arm_a.cross(c.tangent_2);
    c.lever_2_b = root_b * arm_b.cross(c.tangent_2);
    const L zero{};
    const L one = zero + 1;
    const L half = zero + typename Lane<L>::Number(0.5);
    const L least = zero + TINY<L>;
    const L linear = a.inverse_mass + b.inverse_mass;
    const L normal =
        linear + c.lever_a.dot(c.lever_a) * a.turns + c.lever_b.dot(c.lever_b) * b.turns;
    const L k11 =
        linear + c.lever_1_a.dot(c.lever_1_a) * a.turns + c.lever_1_b.dot(c.lever_1_b) * b.turns;
    const L k22 =
        linear + c.lever_2_a.dot(c.lever_2_a) * a.turns + c.lever_2_b.dot(c.lever_2_b) * b.turns;
    const L k12 = c.lever_1_a.dot(c.lever_2_a) * a.turns + c.lever_1_b.dot(c.lever_2_b) * b.turns;
    const L apart = (k11 - k22) * half;
    const L softest = (k11 + k22) * half + root(L(apart * apart + k12 * k12));
    c.tangent_mass = one / larger(softest, least);
    return one / larger(normal, least);
}

// A vector turned by a rotation vector, to the second order.
template <class L> PLUVIA_INLINE Three<L> turned(const Three<L> &arm, const Three<L> &by) {
    const Three<L> first = by.cross(arm);
    const L half = L{} + typename Lane<L>::Number(0.5);
    return arm + first + by.cross(first) * half;
}

template <class L> PLUVIA_INLINE bool any_larger(const L &lanes, typename Lane<L>::Number least) {
    bool any = false;
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        any = any || Lane<L>::get(lanes, i) > least;
    }
    return any;
}

// The speed to reach along the normal in this sub-step, and how the contact
// yields.
//
// A contact that is not closed yet is met exactly at the end of the sub-step,
// a closed one is an implicit spring and damper (Catto 2011, "Soft
// constraints"). Whether it rebounds is decided when this is solved
// (see contact_impacts.h). Velocities are those before gravity.
//
// The spring: stiffness k, damping c = 2 ζ √(k m), in a sub-step h yield
// γ = 1/(h (c + h k)), share of the overlap to remove β = h k/(c + h k).
template <class L>
PLUVIA_INLINE void aim(Batch<L> &c, BatchMemory<L> &m, const LaneLaw<typename Lane<L>::Number> &law,
                       const Bodies<L> &bodies) {
    const L zero{};
    const L one = zero + 1;
    Side<L> a, b;
    gather_motion(bodies.motion.data(), c.a, a);
    gather_motion(bodies.motion.data(), c.b, b);
    L f[8], g[8];
    gather(bodies.way.data(), c.a, f);
    gather(bodies.way.data(), c.b, g);
    const Three<L> moved_a{f[0], f[1], f[2]}, turned_a{f[4], f[5], f[6]};
    const Three<L> moved_b{g[0], g[1], g[2]}, turned_b{g[4], g[5], g[6]};
    const Three<L> turned_arm_a = turned(m.arm_a, turned_a);
    const Three<L> turned_arm_b = turned(m.arm_b, turned_b);
    const Three<L> way = moved_a - moved_b + (turned_arm_a - m.arm_a) - (turned_arm_b - m.arm_b);
    m.gap_now = m.gap + way.dot(c.normal);
    // Both bodies are pushed in one point, nearer to the lighter one's: so the
    // angular momentum is kept, however far they slid past each other, and a
    // block stays on its corners wherever on the plane it is.
    const Three<L> apart = c.normal * m.gap + way;
    const L both = larger(L(a.inverse_mass + b.inverse_mass), L(zero + TINY<L>));
    const Three<L> arm_a = turned_arm_a - apart * L(b.inverse_mass / both);
    const Three<L> arm_b = turned_arm_b + apart * L(a.inverse_mass / both);
    m.mass = set_levers(c, a, b, arm_a, arm_b, bodies);
    m.approach = zero - parting(a, b, c.normal, c.lever_a, c.lever_b);

    const L stiff = zero + law.step * law.stiffness;
    const L firm = root(m.mass) * law.damping + stiff;
    const L yield = one / (firm * law.step);
    const auto closed = m.gap_now <= zero + law.closed_gap;
    const L spring = smaller(L(zero - stiff / firm * m.gap_now * law.inverse_step),
                             L(zero + law.push_out_speed));
    c.target = closed ? spring : L(zero - m.gap_now * law.inverse_step);
    c.normal_mass = closed ? L(m.mass / (one + m.mass * yield)) : m.mass;
    c.yield = closed ? yield : zero;
    c.most = zero + UNLIMITED<L>;
    // Friction that a solved contact was left with beyond its cone is not begun with.
    const L most = c.friction * c.impulse;
    const L size = root(L(c.impulse_1 * c.impulse_1 + c.impulse_2 * c.impulse_2));
    const L scale = most / larger(L(most), larger(size, L(zero + TINY<L>)));
    c.impulse_1 = c.impulse_1 * scale;
    c.impulse_2 = c.impulse_2 * scale;
}

// Applies the impulses that the contacts begin with.
template <class L> PLUVIA_INLINE void begin(const Batch<L> &c, Records<L> *motion) {
    Side<L> a, b;
    gather_motion(motion, c.a, a);
    gather_motion(motion, c.b, b);
    push(a, b, c.normal * c.impulse + c.tangent_1 * c.impulse_1 + c.tangent_2 * c.impulse_2,
         c.lever_a * c.impulse + c.lever_1_a * c.impulse_1 + c.lever_2_a * c.impulse_2,
         c.lever_b * c.impulse + c.lever_1_b * c.impulse_1 + c.lever_2_b * c.impulse_2);
    scatter_motion(a, c.a, motion);
    scatter_motion(b, c.b, motion);
}

// What external forces add to the motion.
template <class N> PLUVIA_INLINE void force(PackedBodies<N> &bodies) {
    for (std::size_t b = 0; b < bodies.motion.size(); ++b) {
        for (int i = 0; i < 8; ++i) {
            bodies.motion[b].at[i] += bodies.forced[b].at[i];
        }
    }
}

// The way that the bodies go.
template <class N> PLUVIA_INLINE void go(PackedBodies<N> &bodies, N step) {
    for (std::size_t b = 0; b < bodies.motion.size(); ++b) {
        const auto &r = bodies.root[b].at;
        const auto &m = bodies.motion[b].at;
        const Symmetric<N> root{r[0], r[1], r[2], r[3], r[4], r[5]};
        const Three<N> spin = root * Three<N>{m[4], m[5], m[6]};
        const N motion[8] = {m[0], m[1], m[2], 0, spin.x, spin.y, spin.z, 0};
        for (int i = 0; i < 8; ++i) {
            bodies.way[b].at[i] += motion[i] * step;
        }
    }
}

} // namespace pluvia
