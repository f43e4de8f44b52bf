#include "contact_iterations.h"

#include "contact_run.h"

#include <cmath>

namespace pluvia {

namespace {

void single(Phase phase, Problem<double> &problem, const Part &part) {
    run_phase(phase, problem, part);
}

void portable(Phase phase, Problem<Float8> &problem, const Part &part) {
    run_phase(phase, problem, part);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void avx2(Phase phase, Problem<Float8> &problem, const Part &part) {
    run_phase(phase, problem, part);
}
#endif

template <class N> LaneLaw<N> lane_law(const ContactLaw &law, double step) {
    const double substep = step / law.substeps;
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

template <class L>
void run_step(Problem<L> &problem, Kernel<L> kernel, const ContactLaw &law, double step,
              const Contacts &contacts, Moves moves, std::vector<SolverBody> &bodies,
              Workers &workers, Look *look) {
    const double substep = step / law.substeps;
    const Colours &colours = contacts.colours;
    const std::size_t packs = colours.packs().size();
    const auto points = static_cast<std::size_t>(colours.points());
    problem.all.resize(packs, points);
    problem.memory.resize(points);
    problem.near.resize(packs);
    problem.awake.resize(packs);
    problem.pairs = &problem.all;
    problem.law = lane_law<typename Lane<L>::Number>(law, step);
    problem.bodies.resize(bodies.size());
    const Homes &homes = contacts.homes;
    // Every pack by the thread at which it is at home.
    const auto at_home = [&](const auto &what) {
        const Share all{packs, std::max<std::size_t>(1, packs), PACKS_AT_ONCE, homes.ends()};
        workers.share(&all, 1, [&](std::size_t, int, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                what(static_cast<std::size_t>(homes.order()[i]));
            }
        });
    };
    at_home([&](std::size_t i) {
        load(contacts.touching, contacts.places, colours, moves, law.substeps, i, problem);
    });
    workers.each(bodies.size(), BODIES_AT_ONCE,
                 [&](std::size_t i) { pack(bodies[i], law.substeps, substep, i, problem.bodies); });
    Run<L> run(problem, kernel, contacts, moves.all, (law.iterations + 1) / 2, workers);
    if (packs > 0) {
        for (int i = 0; i < law.substeps; ++i) {
            run.substep(i + 1 == law.substeps ? look : nullptr);
        }
    }
    at_home([&](std::size_t i) {
        unload(problem, contacts.touching, contacts.places, law.substeps, i);
    });
    workers.each(bodies.size(), BODIES_AT_ONCE, [&](std::size_t i) {
        const int body = static_cast<int>(i);
        if (!moves.still(body) && !colours.touched(body)) {
            fly(bodies[i], law.substeps, substep);
        } else {
            unpack(problem.bodies, i, bodies[i]);
        }
    });
}

} // namespace

bool has_avx2() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

void Iterations::run(Kernels how, const ContactLaw &law, double step, const Contacts &contacts,
                     Moves moves, std::vector<SolverBody> &bodies, Workers &workers, Look *look) {
    if (how == Kernels::OneByOne) {
        run_step(single_, &single, law, step, contacts, moves, bodies, workers, look);
        return;
    }
    Kernel<Float8> kernel = &portable;
#if defined(__x86_64__)
    if (how == Kernels::Avx2) {
        kernel = &avx2;
    }
#endif
    run_step(eight_, kernel, law, step, contacts, moves, bodies, workers, look);
}

} // namespace pluvia
