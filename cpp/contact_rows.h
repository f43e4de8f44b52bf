// One contact point as the solver sees it, set up from Bullet's manifolds and
// written back to them.
#pragma once

#include "lanes.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <vector>

namespace pluvia {

// How contacts yield and rebound; engine units.
struct ContactLaw {
    int substeps;             // of a step
    int sweeps;               // over all contacts in a sub-step
    double stiffness;         // of a contact point, N/m: mass over time squared, whatever the unit
    double damping_ratio;     // of the spring with the bodies it stands between
    double push_out_speed;    // largest speed at which overlap is pushed apart
    double restitution_speed; // approach speed below which nothing rebounds
    double closed_gap;        // gap up to which a contact counts as touching
    double unsolved_gap;      // overlap that a sub-step may add before more sweeps are made
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
    btManifoldPoint *point;
    Three<double> normal, tangent_1, tangent_2, arm_a, arm_b;
    double friction, restitution;
    double gap;                           // when the step began
    double arrival;                       // speed of approach, until they rebound
    double impulse, impulse_1, impulse_2; // of the step
    bool near;                            // may well bear something in the step
};

// Sets up a row of a step of length `step`. The point's m_contactMotion1 holds
// the speed at which the bodies approached each other, until they rebound.
ContactRow make_row(const ContactLaw &law, double step, int a, int b, const SolverBody &body_a,
                    const SolverBody &body_b, const btVector3 &centre_a, const btVector3 &centre_b,
                    btManifoldPoint &point);

// Writes the impulses into the point.
void write_row(const ContactRow &row);

} // namespace pluvia
