// Bodies on their way from Bullet into the solver and back.
#pragma once

#include "contact_law.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <array>

namespace pluvia {

// Asks the memory for what is read of a body below.
void prefetch_body(const btRigidBody &body);

// Its centre of mass.
Vec centre(const btRigidBody &body);

// A body that moves freely, by its weight and by Bullet's forces on it.
SolverBody free_body(const btRigidBody &body);

// Moves a body by what was solved in a step of length `step`, by Bullet's
// integration, and takes the forces of the step from it. `gyroscopic`: uneven
// bodies turn by Euler's equations.
void move_body(btRigidBody &body, const SolverBody &solved, double step, bool gyroscopic);

// Velocities in engine units.
struct KinematicVelocity {
    btVector3 linear, angular;
};

// Those of a kinematic body in a step from one pose to another, as Bullet has them.
KinematicVelocity kinematic_velocity(const btTransform &start, const btTransform &end,
                                     btScalar step);

// A kinematic body's velocities: of the last step, and their change from the one
// before.
struct Drive {
    Vec velocity{0, 0, 0}, spin{0, 0, 0};
    Vec change{0, 0, 0}, spin_change{0, 0, 0};
};

// The same of a body that was driven so in another world: its poses at the ends of
// the last three steps, the last one last.
Drive recalled_drive(const std::array<btTransform, 3> &ends, double step);

// A kinematic body. Bullet knows its mean velocity in the step. Were it the
// velocity of every sub-step, it would jump from step to step, and what rubs on
// the body could not follow within one sub-step. So it changes steadily through
// the step, as it has changed in the last two; where it did jump, it jumps.
SolverBody kinematic_body(const btRigidBody &body, double step, Drive &drive);

// How a body moves that is pressed: along one direction, or about one axis, by a force along it
// or a moment about it and by its contacts alone; its weight is part of that.
struct Press {
    btVector3 direction{0, 0, 1}; // a unit vector; of the axis where it turns
    double inverse_mass = 0;      // of a moment of inertia where it turns
    double force = 0;             // along the direction, in engine units; or a moment
    bool turns = false;
    btVector3 about{0, 0, 0}; // a point of the axis about which it turns
    double unit = 1;          // engine units per N, or per N m
};

SolverBody pressed_body(const btRigidBody &body, const Press &press);

// Moves it by what was solved in a step.
void move_pressed(btRigidBody &body, const SolverBody &solved, const Press &press);

} // namespace pluvia
