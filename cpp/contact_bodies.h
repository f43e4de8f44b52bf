// Bodies on their way from Bullet into the solver and back.
#pragma once

#include "contact_rows.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace pluvia {

// A body with its motion at the end of the step.
struct Moving {
    btRigidBody *body = nullptr;
    Three<double> velocity, spin;
    bool is_momentum = false; // the spin stands for the angular momentum in world axes
};

// A body that moves freely.
SolverBody free_body(const btRigidBody &body);

// Moves the body by what was solved. Bullet will integrate it for a step of
// length `step`; then `end_step` gives it the velocity it has at the end.
// `gyroscopic`: uneven bodies turn by Euler's equations.
Moving begin_step(const SolverBody &from, btRigidBody &body, double step, bool gyroscopic);
void end_step(const Moving &moving);

// A driven body's velocities: of the last step, and their change from the one
// before.
struct Drive {
    Three<double> velocity{0, 0, 0}, spin{0, 0, 0};
    Three<double> change{0, 0, 0}, spin_change{0, 0, 0};
};

// A driven body. Bullet knows its mean velocity in the step. Were it the
// velocity of every sub-step, it would jump from step to step, and what rubs on
// the body could not follow within one sub-step. So it changes steadily through
// the step, as it has changed in the last two; where it did jump, it jumps.
SolverBody driven_body(const btRigidBody &body, double step, Drive &drive);

} // namespace pluvia
