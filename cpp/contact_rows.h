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
    double stiffness;         // of a contact point, N/m: mass over time squared, whatever the unit
    double damping_ratio;     // of the spring with the bodies it stands between
    double push_out_speed;    // largest speed at which overlap is pushed apart
    double restitution_speed; // approach speed below which nothing rebounds
    double closed_gap;        // gap up to which a contact counts as touching
};

// A body in the solver; index 0 is the world at rest.
struct SolverBody {
    Three<double> velocity{0, 0, 0};
    Three<double> spin{0, 0, 0};
    double inverse_mass = 0;
    Symmetric<double> inverse_inertia{0, 0, 0, 0, 0, 0}; // in world axes
};

// One contact point. The normal leads from B to A; arms lead from the centre
// of mass to the point.
struct ContactRow {
    int a, b;
    btManifoldPoint *point;
    Three<double> normal, tangent_1, tangent_2, arm_a, arm_b;
    double friction;
    double normal_mass;                   // with the spring's yield in it
    double yield;                         // gamma: speed per impulse
    double target;                        // normal speed to reach, positive apart
    double tangent_mass;                  // of the direction that resists sliding least
    double impulse, impulse_1, impulse_2; // accumulated
};

// Sets up a row. `step` is the length of the step; velocities are those before
// gravity. Keeps in the point's m_contactMotion1 the speed at which the bodies
// approached each other, until they rebound.
ContactRow make_row(const ContactLaw &law, double step, int a, int b, const SolverBody &body_a,
                    const SolverBody &body_b, const btVector3 &centre_a, const btVector3 &centre_b,
                    btManifoldPoint &point);

// Writes the impulses into the point.
void write_row(const ContactRow &row);

} // namespace pluvia
