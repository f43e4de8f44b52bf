// Runs the native solver over one step: loads pairs and bodies into vector lanes, runs the sub-
// steps with the instructions that the processor has, and writes the results back.
#include "contact_iterations.h"

#include "contact_run.h"

#include <cmath>

namespace pluvia {

namespace {

// By what every processor has.
template <class L> void portable(Phase phase, Problem<L> &problem, const Part &part) {
    run_phase(phase, problem, part);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void avx2(Phase phase, Problem<Float8> &problem, const Part &part) {
    run_phase(phase, problem, part);
}
#endif

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

template <class L>
void run_step(Problem<L> &problem, Run<L> &run, Kernel<L> kernel, const Contacts &contacts,
              Inspection *inspection) {
    const ContactLaw &law = contacts.law;
    const Colours &colours = contacts.colours;
    const Homes &homes = contacts.homes;
    std::vector<SolverBody> &bodies = contacts.bodies;
    Workers &workers = contacts.workers;
    const std::size_t packs = colours.packs().size();
    const auto points = static_cast<std::size_t>(colours.points());
    problem.all.resize(packs, points);
    problem.memory.resize(points);
    problem.near.resize(packs);
    problem.awake.resize(packs);
    problem.pairs = &problem.all;
    problem.law = lane_law<typename Lane<L>::Number>(law, contacts.substep);
    problem.bodies.resize(bodies.size());
    // Every pack by the thread at which it is at home.
    const auto at_home = [&](const auto &what) {
        const Share all{packs, std::max<std::size_t>(1, packs), PACKS_AT_ONCE, homes.ends()};
        workers.share(&all, 1, [&](std::size_t, int, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                what(static_cast<std::size_t>(homes.order()[i]));
            }
        });
    };
    at_home([&](std::size_t i) { load(contacts, i, problem); });
    workers.each(bodies.size(), BODIES_AT_ONCE,
                 [&](std::size_t i) { pack(contacts, i, problem.bodies); });
    problem.contacts = &contacts;
    problem.kernel = kernel;
    run.begin();
    if (packs > 0) {
        for (int i = 0; i < law.substeps; ++i) {
            run.substep(i + 1 == law.substeps ? inspection : nullptr);
        }
    }
    at_home([&](std::size_t i) { unload(problem, contacts, i); });
    workers.each(bodies.size(), BODIES_AT_ONCE, [&](std::size_t i) {
        const int body = static_cast<int>(i);
        if (!contacts.moves.still(body) && !colours.touched(body)) {
            fly(bodies[i], law.substeps, contacts.substep);
        } else {
            unpack(problem.bodies, i, bodies[i]);
        }
    });
}

} // namespace

template <class L> struct Iterations::InLanes {
    Problem<L> problem;
    Run<L> run{problem};
};

Iterations::Iterations()
    : single_(std::make_unique<InLanes<double>>()), eight_(std::make_unique<InLanes<Float8>>()) {}

Iterations::~Iterations() = default;

void Iterations::run(Kernels how, const Contacts &contacts, Inspection *inspection) {
    if (how == Kernels::OneByOne) {
        run_step(single_->problem, single_->run, &portable<double>, contacts, inspection);
        return;
    }
    Kernel<Float8> kernel = &portable<Float8>;
#if defined(__x86_64__)
    if (how == Kernels::Avx2) {
        kernel = &avx2;
    }
#endif
    run_step(eight_->problem, eight_->run, kernel, contacts, inspection);
}

} // namespace pluvia
