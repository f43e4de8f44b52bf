#include "contact_iterations.h"

namespace pluvia {

namespace {

#define PLUVIA_INLINE inline __attribute__((always_inline))

// The bodies of one side of a batch.
template <class L> struct Side {
    Three<L> velocity, spin;
    L inverse_mass;
    Symmetric<L> inertia;
};

template <class L>
PLUVIA_INLINE void gather(const PackedBody<typename Lane<L>::Number> *bodies, const int *index,
                          Side<L> &side) {
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        const auto &body = bodies[index[i]];
        Lane<L>::set(side.velocity.x, i, body.velocity[0]);
        Lane<L>::set(side.velocity.y, i, body.velocity[1]);
        Lane<L>::set(side.velocity.z, i, body.velocity[2]);
        Lane<L>::set(side.spin.x, i, body.spin[0]);
        Lane<L>::set(side.spin.y, i, body.spin[1]);
        Lane<L>::set(side.spin.z, i, body.spin[2]);
        Lane<L>::set(side.inverse_mass, i, body.inverse_mass);
        Lane<L>::set(side.inertia.xx, i, body.inertia[0]);
        Lane<L>::set(side.inertia.yy, i, body.inertia[1]);
        Lane<L>::set(side.inertia.zz, i, body.inertia[2]);
        Lane<L>::set(side.inertia.xy, i, body.inertia[3]);
        Lane<L>::set(side.inertia.xz, i, body.inertia[4]);
        Lane<L>::set(side.inertia.yz, i, body.inertia[5]);
    }
}

// What does not move may stand in several lanes; all write what was there.
template <class L>
PLUVIA_INLINE void scatter(const Side<L> &side, const int *index,
                           PackedBody<typename Lane<L>::Number> *bodies) {
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        auto &body = bodies[index[i]];
        body.velocity[0] = Lane<L>::get(side.velocity.x, i);
        body.velocity[1] = Lane<L>::get(side.velocity.y, i);
        body.velocity[2] = Lane<L>::get(side.velocity.z, i);
        body.spin[0] = Lane<L>::get(side.spin.x, i);
        body.spin[1] = Lane<L>::get(side.spin.y, i);
        body.spin[2] = Lane<L>::get(side.spin.z, i);
    }
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

// Friction first, within the cone that the normal impulse allows so far; the
// normal last, since overlap is worse than a little sliding.
template <class L> PLUVIA_INLINE void solve(Batch<L> &c, Side<L> &a, Side<L> &b) {
    const L zero{};
    Three<L> speed = relative(a, b, c);
    L next_1 = c.impulse_1 - c.tangent_mass * speed.dot(c.tangent_1);
    L next_2 = c.impulse_2 - c.tangent_mass * speed.dot(c.tangent_2);
    const L most = c.friction * c.impulse;
    const L size = root(L(next_1 * next_1 + next_2 * next_2));
    // min(1, most/size), for size 0 as well.
    const L scale = most / larger(L(most), larger(size, L(zero + typename Lane<L>::Number(1e-30))));
    next_1 = next_1 * scale;
    next_2 = next_2 * scale;
    push(a, b, c, c.tangent_1 * L(next_1 - c.impulse_1) + c.tangent_2 * L(next_2 - c.impulse_2));
    c.impulse_1 = next_1;
    c.impulse_2 = next_2;

    speed = relative(a, b, c);
    const L error = speed.dot(c.normal) - c.target + c.yield * c.impulse;
    const L next = larger(zero, L(c.impulse - c.normal_mass * error));
    push(a, b, c, c.normal * L(next - c.impulse));
    c.impulse = next;
}

template <class L>
PLUVIA_INLINE void sweep(std::vector<Batch<L>> &batches, int iterations,
                         std::vector<PackedBody<typename Lane<L>::Number>> &bodies) {
    auto *const body = bodies.data();
    Side<L> a, b;
    for (Batch<L> &c : batches) {
        gather(body, c.a, a);
        gather(body, c.b, b);
        push(a, b, c, c.normal * c.impulse + c.tangent_1 * c.impulse_1 + c.tangent_2 * c.impulse_2);
        scatter(a, c.a, body);
        scatter(b, c.b, body);
    }
    for (int i = 0; i < iterations; ++i) {
        for (Batch<L> &c : batches) {
            gather(body, c.a, a);
            gather(body, c.b, b);
            solve(c, a, b);
            scatter(a, c.a, body);
            scatter(b, c.b, body);
        }
    }
}

void sweep_single(std::vector<Batch<double>> &batches, int iterations,
                  std::vector<PackedBody<double>> &bodies) {
    sweep(batches, iterations, bodies);
}

void sweep_portable(std::vector<Batch<Float8>> &batches, int iterations,
                    std::vector<PackedBody<float>> &bodies) {
    sweep(batches, iterations, bodies);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void sweep_avx2(std::vector<Batch<Float8>> &batches, int iterations,
                                                std::vector<PackedBody<float>> &bodies) {
    sweep(batches, iterations, bodies);
}
#endif

template <class L> void set_three(Three<L> &lanes, int i, const Three<double> &value) {
    using N = typename Lane<L>::Number;
    Lane<L>::set(lanes.x, i, static_cast<N>(value.x));
    Lane<L>::set(lanes.y, i, static_cast<N>(value.y));
    Lane<L>::set(lanes.z, i, static_cast<N>(value.z));
}

template <class L>
void load(const std::vector<ContactRow> &rows, const Schedule &schedule,
          std::vector<Batch<L>> &batches) {
    using N = typename Lane<L>::Number;
    batches.assign(static_cast<std::size_t>(schedule.batches()), Batch<L>{});
    for (Batch<L> &c : batches) {
        for (int &row : c.row) {
            row = -1;
        }
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const ContactRow &row = rows[r];
        Batch<L> &c = batches[static_cast<std::size_t>(schedule.batch()[r])];
        const int i = schedule.lane()[r];
        c.a[i] = row.a;
        c.b[i] = row.b;
        c.row[i] = static_cast<int>(r);
        set_three(c.normal, i, row.normal);
        set_three(c.tangent_1, i, row.tangent_1);
        set_three(c.tangent_2, i, row.tangent_2);
        set_three(c.arm_a, i, row.arm_a);
        set_three(c.arm_b, i, row.arm_b);
        Lane<L>::set(c.friction, i, static_cast<N>(row.friction));
        Lane<L>::set(c.normal_mass, i, static_cast<N>(row.normal_mass));
        Lane<L>::set(c.yield, i, static_cast<N>(row.yield));
        Lane<L>::set(c.target, i, static_cast<N>(row.target));
        Lane<L>::set(c.tangent_mass, i, static_cast<N>(row.tangent_mass));
        Lane<L>::set(c.impulse, i, static_cast<N>(row.impulse));
        Lane<L>::set(c.impulse_1, i, static_cast<N>(row.impulse_1));
        Lane<L>::set(c.impulse_2, i, static_cast<N>(row.impulse_2));
    }
}

template <class N>
void pack(const std::vector<SolverBody> &bodies, std::vector<PackedBody<N>> &packed) {
    packed.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SolverBody &b = bodies[i];
        const Symmetric<double> &m = b.inverse_inertia;
        const double all[13] = {b.velocity.x, b.velocity.y,   b.velocity.z, b.spin.x, b.spin.y,
                                b.spin.z,     b.inverse_mass, m.xx,         m.yy,     m.zz,
                                m.xy,         m.xz,           m.yz};
        N *const to = packed[i].velocity;
        for (int k = 0; k < 13; ++k) {
            to[k] = static_cast<N>(all[k]);
        }
    }
}

template <class L>
void unload(const std::vector<Batch<L>> &batches,
            const std::vector<PackedBody<typename Lane<L>::Number>> &packed,
            std::vector<ContactRow> &rows, std::vector<SolverBody> &bodies) {
    for (const Batch<L> &c : batches) {
        for (int i = 0; i < Lane<L>::WIDTH; ++i) {
            if (c.row[i] >= 0) {
                ContactRow &row = rows[static_cast<std::size_t>(c.row[i])];
                row.impulse = Lane<L>::get(c.impulse, i);
                row.impulse_1 = Lane<L>::get(c.impulse_1, i);
                row.impulse_2 = Lane<L>::get(c.impulse_2, i);
            }
        }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        // What does not move keeps its velocity to the last bit.
        if (bodies[i].inverse_mass > 0) {
            const auto &p = packed[i];
            bodies[i].velocity = {p.velocity[0], p.velocity[1], p.velocity[2]};
            bodies[i].spin = {p.spin[0], p.spin[1], p.spin[2]};
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

void Iterations::run(Sweep how, int iterations, std::vector<ContactRow> &rows,
                     std::vector<SolverBody> &bodies) {
    if (rows.empty()) {
        return;
    }
    if (how == Sweep::OneByOne) {
        schedule_.assign(rows, bodies, 1);
        load(rows, schedule_, single_);
        pack(bodies, single_bodies_);
        sweep_single(single_, iterations, single_bodies_);
        unload(single_, single_bodies_, rows, bodies);
        return;
    }
    schedule_.assign(rows, bodies, Lane<Float8>::WIDTH);
    load(rows, schedule_, eight_);
    pack(bodies, eight_bodies_);
#if defined(__x86_64__)
    if (how == Sweep::Avx2) {
        sweep_avx2(eight_, iterations, eight_bodies_);
    } else {
        sweep_portable(eight_, iterations, eight_bodies_);
    }
#else
    sweep_portable(eight_, iterations, eight_bodies_);
#endif
    unload(eight_, eight_bodies_, rows, bodies);
}

} // namespace pluvia
