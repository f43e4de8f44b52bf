// The arithmetic of the solver on pairs beside each other: how a sub-step is set up, and
// how bodies move. See contact_run.h for what it computes.
#pragma once

#include "contact_packs.h"

namespace pluvia {

// The law with its lengths of time, in the precision of the lanes.
template <class N> struct LaneLaw {
    N step, inverse_step; // of a sub-step
    N stiffness,
        damping; // damping per root of mass: twice the ratio times the root of the stiffness
    N max_depenetration_velocity, restitution_speed, closed_gap;
    N met_gap;             // up to which a contact without impulse is an impact
    N unsolved_speed;      // approach that calls for another iteration
    double unsolved_share; // of what contacts change of a body, that calls for another iteration
};

template <class N> LaneLaw<N> lane_law(const ContactLaw &law, double substep) {
    return {static_cast<N>(substep),
            static_cast<N>(1 / substep),
            static_cast<N>(law.stiffness),
            static_cast<N>(2 * law.damping_ratio * std::sqrt(law.stiffness)),
            static_cast<N>(law.max_depenetration_velocity),
            static_cast<N>(law.restitution_speed),
            static_cast<N>(law.closed_gap),
            static_cast<N>(law.restitution_speed * substep / 2),
            static_cast<N>(law.unsolved_gap / substep),
            law.unsolved_share};
}

template <class L> using Records = Record<typename Lane<L>::Number>;

template <class L> using Bodies = PackedBodies<typename Lane<L>::Number>;

// The motion of the bodies of one side of a pack.
template <class L> struct Side {
    Three<L> velocity, spin; // the spin times the root of the inertia
    L inverse_mass, turns;

    PLUVIA_INLINE Side(const Records<L> *motion, const int *index) {
        L f[8];
        gather(motion, index, f);
        velocity = {f[0], f[1], f[2]};
        inverse_mass = f[3];
        spin = {f[4], f[5], f[6]};
        turns = f[7];
    }
    // What does not move may stand in several lanes, and be read by several threads: it is not
    // written.
    PLUVIA_INLINE void put_back(const int *index, unsigned still, Records<L> *motion) const {
        const L f[8] = {velocity.x, velocity.y, velocity.z, inverse_mass,
                        spin.x,     spin.y,     spin.z,     turns};
        scatter(f, index, still, motion);
    }
};

// Both sides of a pack.
template <class L> struct Sides {
    Side<L> a, b;

    PLUVIA_INLINE Sides(const Pack<L> &pack, const Records<L> *motion)
        : a(motion, pack.a), b(motion, pack.b) {}
    PLUVIA_INLINE void put_back(const Pack<L> &pack, Records<L> *motion) const {
        a.put_back(pack.a, pack.still_a, motion);
        b.put_back(pack.b, pack.still_b, motion);
    }
};

// Lets an impulse act in a point: `by` has its components along the normal and the tangents.
template <class L>
PLUVIA_INLINE void push(Sides<L> &at, const Pack<L> &pack, const Point<L> &c, const Three<L> &by) {
    const Three<L> impulse = pack.normal * by.x + pack.tangent_1 * by.y + pack.tangent_2 * by.z;
    const Three<L> moment_a = c.angular.a * by.x + c.angular_1.a * by.y + c.angular_2.a * by.z;
    const Three<L> moment_b = c.angular.b * by.x + c.angular_1.b * by.y + c.angular_2.b * by.z;
    at.a.velocity = at.a.velocity + impulse * at.a.inverse_mass;
    at.a.spin = at.a.spin + moment_a * at.a.turns;
    at.b.velocity = at.b.velocity - impulse * at.b.inverse_mass;
    at.b.spin = at.b.spin - moment_b * at.b.turns;
}

// Speed at which the bodies part along a direction with the angular Jacobians given.
template <class L>
PLUVIA_INLINE L parting(const Sides<L> &at, const Three<L> &direction, const Jacobian<L> &angular) {
    return (at.a.velocity - at.b.velocity).dot(direction) + at.a.spin.dot(angular.a) -
           at.b.spin.dot(angular.b);
}

// Keeps quotients of nothing by nothing defined.
template <class L>
inline constexpr typename Lane<L>::Number TINY = static_cast<typename Lane<L>::Number>(1e-30);

// The same under a root: the square of what is less than any impulse that matters. In single
// precision the root of TINY is not: impulses of some 5e-12, of grains that come to rest, would be
// rounded otherwise at another scale.
template <class L>
inline constexpr
    typename Lane<L>::Number TINY_SQUARE = sizeof(typename Lane<L>::Number) == 4
                                               ? static_cast<typename Lane<L>::Number>(1e-37)
                                               : static_cast<typename Lane<L>::Number>(1e-300);

// Share of a friction impulse that is within the cone, in which it is at most `most`. (Iterations
// have their own, contact_solve.h.)
template <class L> PLUVIA_INLINE L within_cone(const L &most, const L &first, const L &second) {
    const L size = root(L(first * first + second * second));
    return most / larger(most, larger(size, L(L{} + TINY<L>)));
}

// More than any impulse.
template <class L>
inline constexpr typename Lane<L>::Number UNLIMITED = static_cast<typename Lane<L>::Number>(1e30);

// The Jacobians of lanes whose body is pressed: an impulse acts on its one degree of freedom by
// its component along the path of its point. `press`: that of the origin at unit speed, and the
// axis about which it turns, over the root of the mass or of the moment of inertia.
template <class L>
PLUVIA_INLINE void set_pressed(const Pack<L> &pack, unsigned lanes, const Symmetric<L> &press,
                               const Three<L> &arm, Three<L> &normal, Three<L> &tangent_1,
                               Three<L> &tangent_2) {
    using N = typename Lane<L>::Number;
    const Three<L> origin{press.xx, press.yy, press.zz};
    const Three<L> axis{press.xy, press.xz, press.yz};
    const Three<L> direction = origin + axis.cross(arm);
    const L along[3] = {direction.dot(pack.normal), direction.dot(pack.tangent_1),
                        direction.dot(pack.tangent_2)};
    Three<L> *const jacobians[3] = {&normal, &tangent_1, &tangent_2};
    for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        for (int i = 0; i < 3; ++i) {
            Lane<L>::set(jacobians[i]->x, lane, Lane<L>::get(along[i], lane));
            Lane<L>::set(jacobians[i]->y, lane, N(0));
            Lane<L>::set(jacobians[i]->z, lane, N(0));
        }
    }
}

// Angular Jacobians and masses that the bodies show at the moment arms of the sub-step. With
// those of the step's beginning a body that turns fast, and whose moment arms have
// grown, is pushed by more than it needs, the more so in every iteration.
//
// One mass for all directions of the contact plane, that of the direction that resists sliding
// least: friction of a sliding contact then points against its speed. With the inverse of the 2 x 2
// matrix it would point elsewhere at every corner of a body, and the parts that cancel out would
// use up the cone (a block that slides along its edges was found to lose 8 % of its friction).
//
// Returns the mass along the normal.
template <class L>
PLUVIA_INLINE L set_jacobians(const Pack<L> &pack, Point<L> &c, const Sides<L> &at,
                              const Three<L> &arm_a, const Three<L> &arm_b,
                              const Symmetric<L> &root_a, const Symmetric<L> &root_b) {
    const auto set = [&](const Three<L> &direction, Jacobian<L> &angular) PLUVIA_INLINED {
        angular.a = root_a * arm_a.cross(direction);
        angular.b = root_b * arm_b.cross(direction);
    };
    set(pack.normal, c.angular);
    set(pack.tangent_1, c.angular_1);
    set(pack.tangent_2, c.angular_2);
    if ((pack.pressed_a | pack.pressed_b) != 0) {
        set_pressed(pack, pack.pressed_a, root_a, arm_a, c.angular.a, c.angular_1.a, c.angular_2.a);
        set_pressed(pack, pack.pressed_b, root_b, arm_b, c.angular.b, c.angular_1.b, c.angular_2.b);
    }
    const L zero{};
    const L one = zero + 1;
    const L half = zero + typename Lane<L>::Number(0.5);
    const L least = zero + TINY<L>;
    const L linear = at.a.inverse_mass + at.b.inverse_mass;
    const auto inverse = [&](const Jacobian<L> &on, const Jacobian<L> &to) PLUVIA_INLINED {
        return L(on.a.dot(to.a) * at.a.turns + on.b.dot(to.b) * at.b.turns);
    };
    const L normal = linear + inverse(c.angular, c.angular);
    const L k11 = linear + inverse(c.angular_1, c.angular_1);
    const L k22 = linear + inverse(c.angular_2, c.angular_2);
    const L k12 = inverse(c.angular_1, c.angular_2);
    c.coupling_1 = inverse(c.angular, c.angular_1);
    c.coupling_2 = inverse(c.angular, c.angular_2);
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

// The roots of the inverse inertias of bodies.
template <class L> PLUVIA_INLINE Symmetric<L> roots(const Bodies<L> &bodies, const int *index) {
    L f[8];
    gather(bodies.root.data(), index, f);
    return {f[0], f[1], f[2], f[3], f[4], f[5]};
}

// How bodies have moved and turned since the step began.
template <class L> struct Displacement {
    Three<L> moved, turned;

    PLUVIA_INLINE Displacement(const Bodies<L> &bodies, const int *index) {
        L f[8];
        gather(bodies.displacement.data(), index, f);
        moved = {f[0], f[1], f[2]};
        turned = {f[4], f[5], f[6]};
    }
};

// Where the bodies of a pack are now.
template <class L> struct Placed {
    Displacement<L> a, b;
    Symmetric<L> root_a, root_b;

    PLUVIA_INLINE Placed(const Pack<L> &pack, const Bodies<L> &bodies)
        : a(bodies, pack.a), b(bodies, pack.b), root_a(roots<L>(bodies, pack.a)),
          root_b(roots<L>(bodies, pack.b)) {}

    // Sets gap and mass of a point, and its Jacobians. Both bodies are pushed in one point: so the
    // angular momentum is kept, however far they slid past each other.
    PLUVIA_INLINE void set(const Pack<L> &pack, Point<L> &c, PointMemory<L> &m,
                           const Sides<L> &at) const {
        const Three<L> arm_a = turned(m.arm_a, a.turned, pack.normal);
        const Three<L> arm_b = turned(m.arm_b, b.turned, pack.normal);
        const Three<L> displacement = a.moved - b.moved + (arm_a - m.arm_a) - (arm_b - m.arm_b);
        m.gap_now = m.gap + displacement.dot(pack.normal);
        const Three<L> apart = pack.normal * m.gap + displacement;
        const Three<L> from_a = apart * m.share;
        m.mass =
            set_jacobians(pack, c, at, arm_a - from_a, arm_b + (apart - from_a), root_a, root_b);
    }
};

// The bias velocity along the normal in this sub-step, and the softness of the contact.
//
// A contact that is not closed yet is met exactly at the end of the sub-step, a closed one is an
// implicit spring and damper (Catto 2011, "Soft constraints"). Whether it rebounds is decided when
// this is solved (see contact_impacts.h). Velocities are those before gravity.
//
// The spring: stiffness k, damping c = 2 ζ √(k m), in a sub-step h softness
// γ = 1/(h (c + h k)), share of the overlap to remove β = h k/(c + h k).
template <class L>
PLUVIA_INLINE void prepare(const Pack<L> &pack, Point<L> *points, PointMemory<L> *memory,
                           const LaneLaw<typename Lane<L>::Number> &law, const Bodies<L> &bodies) {
    const L zero{};
    const L one = zero + 1;
    const Sides<L> at(pack, bodies.motion.data());
    const Placed<L> placed(pack, bodies);
    for (int p = 0; p < pack.points; ++p) {
        Point<L> &c = points[p];
        PointMemory<L> &m = memory[p];
        placed.set(pack, c, m, at);
        m.approach = zero - parting(at, pack.normal, c.angular);

        const L stiff = zero + law.step * law.stiffness;
        const L firm = root(m.mass) * law.damping + stiff;
        const L softness = one / (firm * law.step);
        // What comes to an impact is met where the surfaces meet, however near it is: caught
        // before, it would rebound above the surface.
        const auto rests = (m.approach <= zero + law.restitution_speed) | (m.gap_now <= zero);
        const auto closed = (m.gap_now <= zero + law.closed_gap) & rests;
        const L spring = smaller(L(zero - stiff / firm * m.gap_now * law.inverse_step),
                                 L(zero + law.max_depenetration_velocity));
        c.bias = closed ? spring : L(zero - m.gap_now * law.inverse_step);
        c.normal_mass = closed ? L(m.mass / (one + m.mass * softness)) : m.mass;
        c.softness = closed ? softness : zero;
        c.most = zero + UNLIMITED<L>;
        // Friction that a solved contact was left with beyond its cone is not begun with.
        const L most = pack.friction * c.impulse.x;
        const L scale = within_cone(most, c.impulse.y, c.impulse.z);
        c.impulse.y = c.impulse.y * scale;
        c.impulse.z = c.impulse.z * scale;
    }
}

// Whether a point of a pack bears something.
template <class L> PLUVIA_INLINE bool bears(const Pack<L> &pack, const Point<L> *points) {
    bool any = false;
    for (int p = 0; p < pack.points; ++p) {
        any = any || any_larger(points[p].impulse.x, 0);
    }
    return any;
}

// Applies the impulses that the contacts have, or takes them away again.
template <bool AWAY = false, class L>
PLUVIA_INLINE void warm_start(const Pack<L> &pack, const Point<L> *points, Records<L> *motion) {
    Sides<L> at(pack, motion);
    for (int p = 0; p < pack.points; ++p) {
        const Three<L> &by = points[p].impulse;
        push(at, pack, points[p], AWAY ? Three<L>{} - by : by);
    }
    at.put_back(pack, motion);
}

// How far two motions of a body are apart, as an energy.
template <class N> PLUVIA_INLINE N energy(const Record<N> &now, const Record<N> &then) {
    N shift = 0, turn = 0;
    for (int i = 0; i < 3; ++i) {
        shift += (now.at[i] - then.at[i]) * (now.at[i] - then.at[i]);
        turn += (now.at[i + 4] - then.at[i + 4]) * (now.at[i + 4] - then.at[i + 4]);
    }
    return now.at[3] > 0 ? shift / now.at[3] + turn : turn;
}

// What external forces add to the motion of a body.
template <class N> PLUVIA_INLINE void integrate_velocity(PackedBodies<N> &bodies, std::size_t b) {
    for (int i = 0; i < 8; ++i) {
        bodies.motion[b].at[i] += bodies.forced[b].at[i];
    }
    bodies.free[b] = bodies.motion[b];
}

// Begins iterations at the motion that a body has.
template <class N> PLUVIA_INLINE void begin_search(PackedBodies<N> &bodies, std::size_t b) {
    bodies.before[b] = bodies.search[b] = bodies.motion[b];
}

// Extrapolates the motion of a body from where the iteration before the last ended to where the
// last one did, and beyond.
template <class N> PLUVIA_INLINE void extrapolate(PackedBodies<N> &bodies, std::size_t b, N beta) {
    for (int i = 0; i < 8; ++i) {
        const N now = bodies.motion[b].at[i];
        bodies.motion[b].at[i] = now + (now - bodies.search[b].at[i]) * beta;
        bodies.search[b].at[i] = now;
        bodies.before[b].at[i] = bodies.motion[b].at[i];
    }
}

// Adds what a body is displaced by in a sub-step.
template <class N>
PLUVIA_INLINE void integrate_position(PackedBodies<N> &bodies, std::size_t b, N step) {
    const auto &r = bodies.root[b].at;
    const auto &m = bodies.motion[b].at;
    if (bodies.pressed(b)) {
        for (int i = 0; i < 3; ++i) {
            bodies.displacement[b].at[i] += r[i] * m[4] * step;
            bodies.displacement[b].at[4 + i] += r[3 + i] * m[4] * step;
        }
        return;
    }
    const Symmetric<N> root{r[0], r[1], r[2], r[3], r[4], r[5]};
    const Three<N> spin = root * Three<N>{m[4], m[5], m[6]};
    const N motion[8] = {m[0], m[1], m[2], 0, spin.x, spin.y, spin.z, 0};
    for (int i = 0; i < 8; ++i) {
        bodies.displacement[b].at[i] += motion[i] * step;
    }
}

} // namespace pluvia
