// Impacts: what the solver does with contacts that meet with a speed.
//
// A sub-step is solved as if nothing rebounded, which gives the bodies their places at its end.
// Where contacts were closed by it that had been approached faster than the threshold, two phases
// follow that change velocities alone, of the bodies where they are then: with the moment arms of
// the beginning, angular momentum would be lost (Poisson's hypothesis with Newton's as its limit;
// Glocker & Pfeiffer 1995, "Multiple impacts with friction in rigid multibody systems"):
//
// - compression: impacts are brought to a normal speed of zero, all other
//   contacts go on as before;
// - restitution: an impact parts with the coefficient of restitution e times its
//   approach velocity, but its impulse in this phase is at most e times that of
//   the compression; contacts beside it give way no further.
//
// The approach velocity is that of the beginning of the same sub-step, so that no contact rebounds
// from a speed that something else has taken from it. Each phase has friction of its own.
// Compression ends with Coulomb's law for the velocities at its end, which takes energy;
// restitution gives a contact at most ½ (e Λ)(e v), e² of the ½ Λ v that its compression took along
// the normal. With Newton's hypothesis alone, an impact whose slip reverses can gain energy (Kane &
// Levinson 1985).
#pragma once

#include "contact_solve.h"

namespace pluvia {

// Share of the fastest approach to which impacts are solved, where it is more than the
// threshold of restitution.
template <class L>
inline constexpr
    typename Lane<L>::Number IMPACT_SHARE = static_cast<typename Lane<L>::Number>(0.001);

// The approach velocity of the points that are impacts, else 0: those that bore an
// impulse in the sub-step, or are met at its end without one, as a corner of a block may
// be that falls flat: at most half as far off as something at the threshold of restitution
// goes in the sub-step. `speed`: their normal speed now.
template <class L>
PLUVIA_INLINE L impacts(const Point<L> &c, const PointMemory<L> &m, const L &speed,
                        const LaneLaw<typename Lane<L>::Number> &law) {
    const L zero{};
    const auto met = (c.impulse.x > zero) | (m.gap_now + speed * law.step <= zero + law.met_gap);
    const auto impact = met & (m.approach > zero + law.restitution_speed);
    return impact ? m.approach : zero;
}

// Makes `fastest` the fastest of itself and of a pack's impacts.
template <class L>
PLUVIA_INLINE void find_fastest(const Pack<L> &pack, const Point<L> *points,
                                const PointMemory<L> *memory, const Records<L> *motion,
                                const LaneLaw<typename Lane<L>::Number> &law, L &fastest) {
    bool any = false;
    for (int p = 0; p < pack.points; ++p) {
        any = any || any_larger(memory[p].approach, law.restitution_speed);
    }
    if (any) {
        const Sides<L> at(pack, motion);
        for (int p = 0; p < pack.points; ++p) {
            const L speed = parting(at, pack.normal, points[p].angular);
            fastest = larger(fastest, impacts(points[p], memory[p], speed, law));
        }
    }
}

template <class L>
PLUVIA_INLINE void begin_compression(const Pack<L> &pack, Point<L> *points, PointMemory<L> *memory,
                                     const LaneLaw<typename Lane<L>::Number> &law,
                                     const Bodies<L> &bodies) {
    const L zero{};
    const L one = zero + 1;
    const Sides<L> at(pack, bodies.motion.data());
    const Placed<L> placed(pack, bodies);
    for (int p = 0; p < pack.points; ++p) {
        Point<L> &c = points[p];
        PointMemory<L> &m = memory[p];
        const L speed = parting(at, pack.normal, c.angular);
        m.impact = impacts(c, m, speed, law);
        m.solved = c.impulse.x;
        const auto impact = m.impact > zero;
        const L gap = m.gap_now + speed * law.step;
        c.bias = impact ? zero : c.bias;
        c.softness = impact ? zero : c.softness;
        const auto apart = (gap > zero + law.closed_gap) & (c.impulse.x <= zero);
        c.most = apart ? zero : c.most;
        placed.set(pack, c, m, at);
        c.normal_mass = m.mass / (one + m.mass * c.softness);
    }
}

template <class L>
PLUVIA_INLINE void begin_restitution(const Pack<L> &pack, Point<L> *points, PointMemory<L> *memory,
                                     const Records<L> *motion) {
    const L zero{};
    const Sides<L> at(pack, motion);
    for (int p = 0; p < pack.points; ++p) {
        Point<L> &c = points[p];
        PointMemory<L> &m = memory[p];
        const auto impact = m.impact > zero;
        m.compression = c.impulse;
        c.bias = impact ? L(pack.restitution * m.approach)
                        : smaller(parting(at, pack.normal, c.angular), zero);
        c.normal_mass = m.mass;
        c.softness = zero;
        c.most = impact ? L(pack.restitution * c.impulse.x) : c.most;
        c.impulse = Three<L>{};
    }
}

// Adds the phases up. The next sub-step begins with the impulses that were solved
// without restitution, at an impact less what the contact alone would have taken
// for the impact: that says nothing about the force that follows.
template <class L>
PLUVIA_INLINE void store_impact_impulses(const Pack<L> &pack, Point<L> *points,
                                         PointMemory<L> *memory) {
    const L zero{};
    for (int p = 0; p < pack.points; ++p) {
        Point<L> &c = points[p];
        PointMemory<L> &m = memory[p];
        const Three<L> all = m.compression + c.impulse;
        m.total = m.total + all;
        const L impulse = m.impact > zero ? L(m.mass * m.approach * (pack.restitution + 1)) : zero;
        const L next = larger(zero, smaller(L(m.solved - impulse), all.x));
        const L share = next / larger(all.x, L(zero + TINY<L>));
        c.impulse = {next, all.y * share, all.z * share};
    }
}

// Adds up the impulses of a sub-step without impacts.
template <class L>
PLUVIA_INLINE void store_force_impulses(const Pack<L> &pack, const Point<L> *points,
                                        PointMemory<L> *memory) {
    for (int p = 0; p < pack.points; ++p) {
        memory[p].total = memory[p].total + points[p].impulse;
    }
}

} // namespace pluvia
