// Laws of impact that let contacts rebound. Each is a Law of pour.h.
#pragma once

#include "pour.h"

namespace referee {

// Compression, then restitution (after Poisson, bounded by Newton's quotient).
//
// Compression is `inelastic`, with those contacts closed that bear something in
// the step. In restitution a contact that bore an impulse and was approached
// faster than `threshold` when the step began parts with `restitution` times
// that speed, unless the impulse for it exceeds `restitution` times that of
// compression; then it gets this much. All others do not close any further.
// Friction is Coulomb's in both phases.
Law compression_and_restitution(double restitution, double threshold);

} // namespace referee
