// Laws of impact that let contacts rebound. Each is a Law of pour.h.
#pragma once

#include "pour.h"

namespace referee {

// What counts as an impact, and how it rebounds.
struct ImpactRule {
    double restitution = 0; // coefficient
    double threshold = 0;   // approach speed up to which nothing is an impact, m/s
    double closed_gap = 0;  // gap up to which what bears nothing takes part, m
    double met_gap = 0;     // gap up to which what bears nothing may be an impact, m
};

// The rule of docs/contacts.md, 'Restitution': compression, whatever the coefficient,
// then restitution (after Poisson, bounded by Newton's quotient). Both change
// velocities alone.
//
// A contact is an impact that bears something in the first solution, or is met after it
// without (gap up to `met_gap`), and was approached faster than `threshold` when the
// step began. Compression brings impacts to a normal speed of zero, while others go on
// as before; what is open (gap above `closed_gap`) and bears nothing stays without
// impulse. In restitution an impact parts with `restitution` times its approach speed,
// unless the impulse for it exceeds `restitution` times that of compression; then it
// gets this much. All others give way no further. Friction is Coulomb's in both phases.
Law compression_and_restitution(const ImpactRule &rule);

} // namespace referee
