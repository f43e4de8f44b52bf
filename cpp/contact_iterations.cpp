// Compiles the native solver for one pair at a time and for eight, with the instructions that every
// processor has and with AVX2, and runs a step with those that are asked for.
#include "contact_iterations.h"

#include "contact_run.h"

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

} // namespace

Iterations::Iterations()
    : single_(std::make_unique<Run<double>>()), eight_(std::make_unique<Run<Float8>>()) {}

Iterations::~Iterations() = default;

void Iterations::run(Kernels how, const Contacts &contacts, Inspection *inspection) {
    if (how == Kernels::OneByOne) {
        single_->step(&portable<double>, contacts, inspection);
        return;
    }
    Kernel<Float8> kernel = &portable<Float8>;
#if defined(__x86_64__)
    if (how == Kernels::Avx2) {
        kernel = &avx2;
    }
#endif
    eight_->step(kernel, contacts, inspection);
}

} // namespace pluvia
