// Impacts: what the solver does with contacts that meet with a speed, and the
// sub-step that all of it makes.
//
// A sub-step is solved as if nothing rebounded, which gives the bodies their
// places at its end. Where contacts were closed by it that had been approached
// faster than the threshold, two phases follow that change velocities alone
// (Poisson's hypothesis with Newton's as its limit; Glocker & Pfeiffer 1995,
// "Multiple impacts with friction in rigid multibody systems"):
//
// - compression: impacts are brought to a normal speed of zero, all other
//   contacts go on as before;
// - restitution: an impact parts with the coefficient of restitution e times its
//   approach velocity, but its impulse in this phase is at most e times that of
//   the compression; contacts beside it give way no further.
//
// The approach velocity is that of the beginning of the same sub-step, so that
// no contact rebounds from a speed that something else has taken from it. Each
// phase has friction of its own. Compression ends with Coulomb's law for the
// velocities at its end, which takes energy; restitution gives a contact at most
// ½ (e Λ)(e v), e² of the ½ Λ v that its compression took along the normal. With
// Newton's hypothesis alone, an impact whose slip reverses can gain energy
// (Kane & Levinson 1985).
#pragma once

#include "contact_residual.h"

namespace pluvia {

// Share of the fastest approach to which impacts are solved, where it is more than the
// threshold of restitution.
template <class L>
inline constexpr
    typename Lane<L>::Number IMPACT_SHARE = static_cast<typename Lane<L>::Number>(0.001);

// The approach velocity of the contacts of a batch that are impacts, else 0:
// those that bore an impulse in the sub-step, or are closed at its end without one,
// as a corner of a block may be that falls flat. `speed`: their normal speed now.
template <class L>
PLUVIA_INLINE L impacts(const Batch<L> &c, const BatchMemory<L> &m, const L &speed,
                        const LaneLaw<typename Lane<L>::Number> &law) {
    const L zero{};
    const auto met = (c.impulse > zero) | (m.gap_now + speed * law.step <= zero + law.closed_gap);
    const auto impact = met & (m.approach > zero + law.restitution_speed);
    return impact ? m.approach : zero;
}

// Normal speed of the contacts now.
template <class L> PLUVIA_INLINE L normal_speed(const Batch<L> &c, const Records<L> *motion) {
    Side<L> a, b;
    gather_motion(motion, c.a, a);
    gather_motion(motion, c.b, b);
    return parting(a, b, c.normal, c.lever_a, c.lever_b);
}

template <class L>
PLUVIA_INLINE void begin_compression(Batch<L> &c, BatchMemory<L> &m, const L &speed,
                                     const LaneLaw<typename Lane<L>::Number> &law) {
    const L zero{};
    m.impact = impacts(c, m, speed, law);
    m.solved = c.impulse;
    const auto impact = m.impact > zero;
    const L gap = m.gap_now + speed * law.step;
    c.target = impact ? zero : c.target;
    c.normal_mass = impact ? m.mass : c.normal_mass;
    c.yield = impact ? zero : c.yield;
    const auto apart = (gap > zero + law.closed_gap) & (c.impulse <= zero);
    c.most = apart ? zero : c.most;
}

template <class L>
PLUVIA_INLINE void begin_restitution(Batch<L> &c, BatchMemory<L> &m, const L &speed) {
    const L zero{};
    const auto impact = m.impact > zero;
    m.compression = c.impulse;
    m.compression_1 = c.impulse_1;
    m.compression_2 = c.impulse_2;
    c.target = impact ? L(m.restitution * m.approach) : smaller(speed, zero);
    c.normal_mass = m.mass;
    c.yield = zero;
    c.most = impact ? L(m.restitution * c.impulse) : c.most;
    c.impulse = c.impulse_1 = c.impulse_2 = zero;
}

// Adds the phases up. The next sub-step begins with the impulses that were solved
// without restitution, at an impact less what the contact alone would have taken
// for the blow: that says nothing about the force that follows.
template <class L> PLUVIA_INLINE void end_impacts(Batch<L> &c, BatchMemory<L> &m) {
    const L zero{};
    const L all = m.compression + c.impulse;
    const L all_1 = m.compression_1 + c.impulse_1;
    const L all_2 = m.compression_2 + c.impulse_2;
    m.total = m.total + all;
    m.total_1 = m.total_1 + all_1;
    m.total_2 = m.total_2 + all_2;
    const L blow = m.impact > zero ? L(m.mass * m.approach * (m.restitution + 1)) : zero;
    const L next = larger(zero, smaller(L(m.solved - blow), all));
    const L share = next / larger(all, L(zero + TINY<L>));
    c.impulse = next;
    c.impulse_1 = all_1 * share;
    c.impulse_2 = all_2 * share;
}

// One sub-step: external forces, the impulses with which it begins, the sweeps,
// the way the bodies go, and what impacts add. `look`, or null, gets how well it
// was solved before impacts.
template <class L>
PLUVIA_INLINE void substep(Contacts<L> &contacts, int sweeps,
                           const LaneLaw<typename Lane<L>::Number> &law, Bodies<L> &bodies,
                           Look *look) {
    auto *const motion = bodies.motion.data();
    auto &batches = contacts.batches;
    auto &memory = contacts.memory;
    for (std::size_t i = 0; i < batches.size(); ++i) {
        aim(batches[i], memory[i], law, bodies);
        contacts.awake[i] = i < contacts.near || any_larger(batches[i].impulse, 0);
    }
    force(bodies);
    bodies.free = bodies.motion;
    if (look != nullptr && look->record != nullptr) {
        record_bodies(bodies, false, *look->record);
    }
    for (std::size_t i = 0; i < batches.size(); ++i) {
        if (contacts.awake[i]) {
            begin(batches[i], motion);
        }
    }
    iterate<Solved::Forces>(contacts, sweeps, law.unsolved_speed, law.unsolved_share, bodies);
    if (look != nullptr) {
        for (const Batch<L> &batch : batches) {
            add_residual(batch, motion, look->residual);
        }
        if (look->record != nullptr) {
            record_bodies(bodies, true, *look->record);
            record_contacts(contacts, *look->record);
        }
    }
    go(bodies, law.step);

    L fastest{};
    for (std::size_t i = 0; i < batches.size(); ++i) {
        const L approach = memory[i].approach;
        if (any_larger(approach, law.restitution_speed)) {
            fastest = larger(fastest,
                             impacts(batches[i], memory[i], normal_speed(batches[i], motion), law));
        }
    }
    if (!any_larger(fastest, 0)) {
        for (std::size_t i = 0; i < batches.size(); ++i) {
            BatchMemory<L> &m = memory[i];
            m.total = m.total + batches[i].impulse;
            m.total_1 = m.total_1 + batches[i].impulse_1;
            m.total_2 = m.total_2 + batches[i].impulse_2;
        }
        return;
    }
    auto limit = law.restitution_speed;
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        const typename Lane<L>::Number share = Lane<L>::get(fastest, i) * IMPACT_SHARE<L>;
        limit = share > limit ? share : limit;
    }
    for (std::size_t i = 0; i < batches.size(); ++i) {
        begin_compression(batches[i], memory[i], normal_speed(batches[i], motion), law);
    }
    iterate<Solved::Impacts>(contacts, sweeps, limit, 0, bodies);
    for (std::size_t i = 0; i < batches.size(); ++i) {
        begin_restitution(batches[i], memory[i], normal_speed(batches[i], motion));
    }
    iterate<Solved::Impacts>(contacts, sweeps, limit, 0, bodies);
    for (std::size_t i = 0; i < batches.size(); ++i) {
        end_impacts(batches[i], memory[i]);
    }
}

} // namespace pluvia
