// Projected Gauss–Seidel over contacts in sub-steps: the arithmetic of the solver.
#pragma once

#include "contact_load.h"

#include <memory>

namespace pluvia {

template <class L> class Run;

// How iterations are computed. All give the same law; the two in eight lanes
// give the same bits, on any number of threads.
enum class Kernels {
    OneByOne, // double precision, one pair at a time
    Portable, // single precision, eight at a time, whatever the machine has
    Avx2,     // single precision, eight at a time, with AVX2
};

// Carries bodies and contacts through a step of `law.substeps` sub-steps. In each the gaps and arms
// are what they have become, the external forces act, the contacts begin with the impulses of the
// sub-step before (the first with its share of those of the last step), and iterations correct them
// until they are solved. Normals are those of the beginning.
//
// Smaller steps of the solver do more for the same work than more iterations (Macklin et al. 2019,
// "Small steps in physics simulation"). Pairs end with the impulses of the whole step, bodies with
// their velocities at its end and their displacement.
class Iterations {
  public:
    Iterations();
    ~Iterations();

    // `inspection`, or null, is filled in the last sub-step.
    void run(Kernels how, const Contacts &contacts, Inspection *inspection);

  private:
    std::unique_ptr<Run<double>> single_;
    std::unique_ptr<Run<Float8>> eight_;
};

} // namespace pluvia
