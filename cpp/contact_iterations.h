// Projected Gauss–Seidel over contacts in sub-steps: the arithmetic of the solver.
#pragma once

#include "contact_batches.h"
#include "contact_look.h"

namespace pluvia {

// How the sweeps over the contacts are carried out. All give the same law;
// the two in eight lanes give the same bits.
enum class Sweep {
    OneByOne, // double precision, one contact at a time
    Portable, // single precision, eight at a time, whatever the machine has
    Avx2,     // single precision, eight at a time, with AVX2
};

// Whether this machine has AVX2.
bool has_avx2();

// Carries bodies and contacts through a step of `law.substeps` sub-steps. In
// each the gaps and arms are what they have become, the external forces act, the
// contacts begin with the impulses of the sub-step before (the first with its
// share of those in the rows), and `law.sweeps` sweeps correct them. Normals
// are those of the beginning.
//
// Smaller steps of the solver do more for the same work than more sweeps
// (Macklin et al. 2019, "Small steps in physics simulation"). Rows end with the
// impulses of the whole step, bodies with their velocities at its end and the
// way they have gone. `look`, or null, is filled in the last sub-step.
class Iterations {
  public:
    void run(Sweep sweep, const ContactLaw &law, double step, ContactRows &rows,
             std::vector<SolverBody> &bodies, Look *look);

  private:
    Schedule schedule_;
    Contacts<double> single_;
    PackedBodies<double> single_bodies_;
    Contacts<Float8> eight_;
    PackedBodies<float> eight_bodies_;
};

} // namespace pluvia
