#include "contact_iterations.h"

#include "contact_impacts.h"

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

void step_single(Contacts<double> &contacts, const ContactLaw &law, const LaneLaw<double> &lanes,
                 PackedBodies<double> &bodies, Look *look) {
    for (int i = 0; i < law.substeps; ++i) {
        substep(contacts, law.sweeps, lanes, bodies, i + 1 == law.substeps ? look : nullptr);
    }
}

void step_portable(Contacts<Float8> &contacts, const ContactLaw &law, const LaneLaw<float> &lanes,
                   PackedBodies<float> &bodies, Look *look) {
    for (int i = 0; i < law.substeps; ++i) {
        substep(contacts, law.sweeps, lanes, bodies, i + 1 == law.substeps ? look : nullptr);
    }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void step_avx2(Contacts<Float8> &contacts, const ContactLaw &law,
                                               const LaneLaw<float> &lanes,
                                               PackedBodies<float> &bodies, Look *look) {
    for (int i = 0; i < law.substeps; ++i) {
        substep(contacts, law.sweeps, lanes, bodies, i + 1 == law.substeps ? look : nullptr);
    }
}
#endif

template <class N> LaneLaw<N> lane_law(const ContactLaw &law, double step) {
    const double substep = step / law.substeps;
    return {static_cast<N>(substep),
            static_cast<N>(1 / substep),
            static_cast<N>(law.stiffness),
            static_cast<N>(2 * law.damping_ratio * std::sqrt(law.stiffness)),
            static_cast<N>(law.push_out_speed),
            static_cast<N>(law.restitution_speed),
            static_cast<N>(law.closed_gap),
            static_cast<N>(law.unsolved_gap / substep),
            law.unsolved_share};
}

template <class L> void set_three(Three<L> &lanes, int i, const Three<double> &value) {
    using N = typename Lane<L>::Number;
    Lane<L>::set(lanes.x, i, static_cast<N>(value.x));
    Lane<L>::set(lanes.y, i, static_cast<N>(value.y));
    Lane<L>::set(lanes.z, i, static_cast<N>(value.z));
}

template <class L>
void load(const ContactRows &rows, const Schedule &schedule, int substeps, Contacts<L> &contacts) {
    using N = typename Lane<L>::Number;
    const auto count = static_cast<std::size_t>(schedule.batches());
    contacts.batches.resize(count);
    contacts.memory.resize(count);
    contacts.awake.assign(count, 1);
    contacts.near = static_cast<std::size_t>(schedule.near_batches());
    for (std::size_t i = 0; i < count; ++i) {
        BatchMemory<L> &m = contacts.memory[i];
        m.total = m.total_1 = m.total_2 = L{};
        if (schedule.lanes_used(i) < Lane<L>::WIDTH) {
            contacts.batches[i] = Batch<L>{};
            m = BatchMemory<L>{};
            std::fill(m.row, m.row + Lane<L>::WIDTH, -1);
        }
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const ContactRow &row = rows[r];
        Batch<L> &c = contacts.batches[static_cast<std::size_t>(schedule.batch()[r])];
        BatchMemory<L> &m = contacts.memory[static_cast<std::size_t>(schedule.batch()[r])];
        const int i = schedule.lane()[r];
        const auto put = [i](L &lanes, double value) {
            Lane<L>::set(lanes, i, static_cast<N>(value));
        };
        c.a[i] = row.a;
        c.b[i] = row.b;
        m.row[i] = static_cast<int>(r);
        set_three(c.normal, i, row.normal);
        set_three(c.tangent_1, i, row.tangent_1);
        set_three(c.tangent_2, i, row.tangent_2);
        set_three(m.arm_a, i, row.arm_a);
        set_three(m.arm_b, i, row.arm_b);
        put(c.friction, row.friction);
        put(m.restitution, row.restitution);
        put(m.gap, row.gap);
        const double kept = row.kept / substeps;
        put(c.impulse, row.impulse * kept);
        put(c.impulse_1, row.impulse_1 * kept);
        put(c.impulse_2, row.impulse_2 * kept);
    }
}

template <class N>
void pack(const std::vector<SolverBody> &bodies, int substeps, double substep,
          PackedBodies<N> &packed) {
    packed.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SolverBody &b = bodies[i];
        const bool moves = b.inverse_mass > 0;
        Three<double> velocity = b.velocity;
        Three<double> spin = b.spin;
        if (!moves) {
            // A driven body's velocity is its mean in the step.
            const double before = substep * (substeps + 1) / 2;
            velocity = velocity - b.acceleration * before;
            spin = spin - b.spin_up * before;
        }
        spin = b.inertia_root * spin;
        const double motion[8] = {velocity.x, velocity.y, velocity.z, b.inverse_mass,
                                  spin.x,     spin.y,     spin.z,     moves ? 1.0 : 0.0};
        const Symmetric<double> &m = b.inverse_inertia_root;
        const double root[8] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, 0, 0};
        const Three<double> v = b.acceleration * substep;
        const Three<double> w = b.inertia_root * b.spin_up * substep;
        const double forced[8] = {v.x, v.y, v.z, 0, w.x, w.y, w.z, 0};
        for (int k = 0; k < 8; ++k) {
            packed.motion[i].at[k] = static_cast<N>(motion[k]);
            packed.root[i].at[k] = static_cast<N>(root[k]);
            packed.way[i].at[k] = 0;
            packed.forced[i].at[k] = static_cast<N>(forced[k]);
        }
    }
}

// A step without contacts: the sum over its sub-steps.
void fly(SolverBody &body, int substeps, double substep) {
    const double step = substeps * substep;
    const double mean = step * (substep * (substeps + 1) / 2);
    body.shift = body.velocity * step + body.acceleration * mean;
    body.turn = body.spin * step + body.spin_up * mean;
    body.velocity = body.velocity + body.acceleration * step;
    body.spin = body.spin + body.spin_up * step;
}

template <class L>
void unload(const Contacts<L> &contacts, const Bodies<L> &packed, const Schedule &schedule,
            const ContactLaw &law, double substep, ContactRows &rows,
            std::vector<SolverBody> &bodies) {
    for (std::size_t n = 0; n < contacts.memory.size(); ++n) {
        const BatchMemory<L> &m = contacts.memory[n];
        for (int i = 0; i < Lane<L>::WIDTH; ++i) {
            if (m.row[i] >= 0) {
                ContactRow &row = rows[static_cast<std::size_t>(m.row[i])];
                row.impulse = Lane<L>::get(m.total, i);
                row.impulse_1 = Lane<L>::get(m.total_1, i);
                row.impulse_2 = Lane<L>::get(m.total_2, i);
                const double next = Lane<L>::get(contacts.batches[n].impulse, i);
                row.kept = row.impulse > 0 ? next * law.substeps / row.impulse : 1;
            }
        }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        SolverBody &body = bodies[i];
        if (!schedule.touched(i)) {
            fly(body, law.substeps, substep);
        } else {
            const auto &m = packed.motion[i].at;
            const auto &w = packed.way[i].at;
            body.velocity = {m[0], m[1], m[2]};
            body.spin = body.inverse_inertia_root * Three<double>{m[4], m[5], m[6]};
            body.shift = {w[0], w[1], w[2]};
            body.turn = {w[4], w[5], w[6]};
        }
    }
}

} // namespace

bool has_avx2() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

void Iterations::run(Sweep how, const ContactLaw &law, double step, ContactRows &rows,
                     std::vector<SolverBody> &bodies, Look *look) {
    const double substep = step / law.substeps;
    if (how == Sweep::OneByOne) {
        schedule_.assign(rows, bodies, 1);
        load(rows, schedule_, law.substeps, single_);
        pack(bodies, law.substeps, substep, single_bodies_);
        step_single(single_, law, lane_law<double>(law, step), single_bodies_, look);
        unload(single_, single_bodies_, schedule_, law, substep, rows, bodies);
        return;
    }
    schedule_.assign(rows, bodies, Lane<Float8>::WIDTH);
    load(rows, schedule_, law.substeps, eight_);
    pack(bodies, law.substeps, substep, eight_bodies_);
    const LaneLaw<float> lanes = lane_law<float>(law, step);
#if defined(__x86_64__)
    if (how == Sweep::Avx2) {
        step_avx2(eight_, law, lanes, eight_bodies_, look);
    } else {
        step_portable(eight_, law, lanes, eight_bodies_, look);
    }
#else
    step_portable(eight_, law, lanes, eight_bodies_, look);
#endif
    unload(eight_, eight_bodies_, schedule_, law, substep, rows, bodies);
}

} // namespace pluvia
