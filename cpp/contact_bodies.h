// Bodies as the solver has them: read from Bullet, and moved by what was found.
#pragma once

#include "three.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <array>

namespace pluvia {

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
    double reach = 0; // of one that turns, as that of its Press

    bool turned() const { return press_turn.dot(press_turn) > 0; }
    bool pressed() const { return press.dot(press) > 0 || turned(); }
};

// Asks the memory for what is read of a body below.
void prefetch_body(const btRigidBody &body);

// A body that moves freely, by its weight and by Bullet's forces on it.
SolverBody free_body(const btRigidBody &body);

// Moves a body by what was solved in a step of length `step`, by Bullet's integration, and takes
// the forces of the step from it. `gyroscopic`: uneven bodies turn by Euler's equations.
void move_body(btRigidBody &body, const SolverBody &solved, double step, bool gyroscopic);

// A kinematic body's velocities: of the last step, and their change from the one before.
struct Drive {
    Vec velocity{0, 0, 0}, spin{0, 0, 0};
    Vec change{0, 0, 0}, spin_change{0, 0, 0};
};

// The same of a body that moved so in another world: its poses at the ends of
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
    double reach = 0;         // no point of what turns is farther from the axis than that
    double unit = 1;          // engine units per N, or per N m

    // Has all of a body within the reach.
    void hold(const btRigidBody &body);

    // By how much faster it is at the end of a step than at its beginning, at its farthest point,
    // if it goes on as in the step before, with the force of now; in its first step, if nothing
    // stands against the force, or where it `goes_on` all of it. To be called once a step.
    double gain(const btRigidBody &body, double step, bool goes_on);

  private:
    // When the step before began.
    bool known_ = false;
    double speed_ = 0, force_ = 0;
};

SolverBody pressed_body(const btRigidBody &body, const Press &press);

// Moves it by what was solved in a step.
void move_pressed(btRigidBody &body, const SolverBody &solved, const Press &press);

} // namespace pluvia
