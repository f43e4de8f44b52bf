// What the contact solver is given: the law of contacts and the bodies.
#pragma once

#include "lanes.h"

namespace pluvia {

// How contacts yield and rebound; engine units.
struct ContactLaw {
    int substeps;         // of a step
    int iterations;       // over all contacts in a sub-step, at least
    double stiffness;     // of a contact point, N/m: mass over time squared, whatever the unit
    double damping_ratio; // of the spring with the bodies it stands between
    double max_depenetration_velocity; // largest speed at which overlap is pushed apart
    double restitution_speed;          // approach speed below which nothing rebounds
    double closed_gap;                 // gap up to which what does not come fast counts as closed
    double unsolved_gap; // overlap that a sub-step may add before it is iterated further
    // Of what contacts change of a body in a sub-step, the mean of all: what the last
    // iteration may change of any.
    double unsolved_share;
};

// A body in the solver; number 0 is the world at rest.
struct SolverBody {
    Vec velocity{0, 0, 0};
    Vec spin{0, 0, 0};
    double inverse_mass = 0;
    // Roots of the inertia and of its inverse, in world axes.
    Symmetric<double> inertia_root{1, 1, 1, 0, 0, 0};
    Symmetric<double> inverse_inertia_root{1, 1, 1, 0, 0, 0};
    // By external forces, or of a kinematic body within the step.
    Vec acceleration{0, 0, 0}, spin_up{0, 0, 0};
    Vec shift{0, 0, 0}, turn{0, 0, 0}; // gone in the step
    // Of a pressed body, which moves along one direction alone: its unit vector over the root of
    // the mass. Else 0. Of one that turns about an axis: the velocity of its origin at unit speed,
    // and the unit vector of the axis, over the root of the moment of inertia.
    Vec press{0, 0, 0};
    Vec press_turn{0, 0, 0};

    bool turned() const { return press_turn.dot(press_turn) > 0; }
    bool pressed() const { return press.dot(press) > 0 || turned(); }
};

} // namespace pluvia
