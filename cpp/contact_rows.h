// One contact point as the solver sees it, set up from what the pair carries
// and written back to it.
#pragma once

#include "hull_algorithm.h"
#include "lanes.h"
#include "unset.h"

#include <vector>

namespace pluvia {

// How contacts yield and rebound; engine units.
struct ContactLaw {
    int substeps;             // of a step
    int sweeps;               // over all contacts in a sub-step, at least
    double stiffness;         // of a contact point, N/m: mass over time squared, whatever the unit
    double damping_ratio;     // of the spring with the bodies it stands between
    double push_out_speed;    // largest speed at which overlap is pushed apart
    double restitution_speed; // approach speed below which nothing rebounds
    double closed_gap;        // gap up to which a contact counts as touching
    double unsolved_gap;      // overlap that a sub-step may add before more sweeps are made
    // Of what contacts change of a body in a sub-step: what the last round may change of a contact.
    double unsolved_share;
};

// A body in the solver; index 0 is the world at rest.
struct SolverBody {
    Three<double> velocity{0, 0, 0};
    Three<double> spin{0, 0, 0};
    double inverse_mass = 0;
    // Roots of the inertia and of its inverse, in world axes.
    Symmetric<double> inertia_root{1, 1, 1, 0, 0, 0};
    Symmetric<double> inverse_inertia_root{1, 1, 1, 0, 0, 0};
    // By external forces, or of a driven body within the step.
    Three<double> acceleration{0, 0, 0}, spin_up{0, 0, 0};
    Three<double> shift{0, 0, 0}, turn{0, 0, 0}; // gone in the step
};

// One contact point. The normal leads from B to A; arms lead from the centre
// of mass to the point.
struct ContactRow {
    int a, b;
    Load *load; // of the point
    Three<double> normal, tangent_1, tangent_2, arm_a, arm_b;
    double friction, restitution;
    double gap;                           // when the step began
    double kept;                          // share of the last step's impulse to begin with
    double impulse, impulse_1, impulse_2; // of the step
    bool near;                            // may well bear something in the step
};
using ContactRows = UnsetVector<ContactRow>;

// Sets up the row of a pair's point for a step of length `step`.
ContactRow make_row(const ContactLaw &law, double step, const Touching &pair, int point, int a,
                    int b, const SolverBody &body_a, const SolverBody &body_b);

// Writes what was found into the point's load.
void write_row(const ContactRow &row);

} // namespace pluvia
