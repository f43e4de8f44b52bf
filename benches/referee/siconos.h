// The same problem solved by Siconos' library of numerics.
#pragma once

#include "solve.h"

namespace referee {

// Solves with Siconos' nonsmooth Gauss–Seidel method from a start; the residual is
// the referee's. (Its Newton method, NSN_AC, meets singular matrices where several
// points carry one face.)
Solution solve_with_siconos(const System &system, const Impulses &start, double tolerance,
                            int iterations);

// Siconos' own measure of error for impulses: the natural map with a factor of 1, over the
// norm of the relative velocities without impulses. It mixes impulses with velocities, and
// depends on their units.
double siconos_error(const System &system, const Impulses &impulses);

} // namespace referee
