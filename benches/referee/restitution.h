// Laws of impact that let contacts rebound. Each is a Law of pour.h.
#pragma once

#include "pour.h"

namespace referee {

// The rule of docs/contacts.md, 'Restitution': compression, whatever the coefficient,
// then restitution (after Poisson, bounded by Newton's quotient). Both change
// velocities alone.
//
// A contact is an impact that bears something in the first solution, or is closed after
// it (gap up to `closed_gap`, m), and was approached faster than `threshold` when the
// step began. Compression brings impacts to a normal speed of zero, while others go on
// as before; what is open and bears nothing stays without impulse. In restitution an
// impact parts with `restitution` times its approach speed, unless the impulse for it
// exceeds `restitution` times that of compression; then it gets this much. All others
// give way no further. Friction is Coulomb's in both phases.
Law compression_and_restitution(double restitution, double threshold, double closed_gap = 1e-5);

} // namespace referee
