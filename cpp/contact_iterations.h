// Projected Gauss–Seidel over contacts: the arithmetic of the solver.
#pragma once

#include "contact_batches.h"

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

// Applies the rows' accumulated impulses to the bodies, then sweeps over all
// rows `iterations` times. Rows and bodies end with the result.
class Iterations {
  public:
    void run(Sweep sweep, int iterations, std::vector<ContactRow> &rows,
             std::vector<SolverBody> &bodies);

  private:
    Schedule schedule_;
    std::vector<Batch<double>> single_;
    std::vector<PackedBody<double>> single_bodies_;
    std::vector<Batch<Float8>> eight_;
    std::vector<PackedBody<float>> eight_bodies_;
};

} // namespace pluvia
