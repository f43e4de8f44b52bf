// Bodies that are driven, on Pluvia's own contact path.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

namespace pluvia {

// Velocities in engine units.
struct DrivenVelocity {
    btVector3 linear, angular;
};

// Those that Bullet gives a driven body for a step from one pose to another, to
// the bit.
DrivenVelocity driven_velocity(const btTransform &start, const btTransform &end, btScalar step);

// Contacts are found where bodies are at the beginning of the step, driven ones
// as all others: Bullet would have those where they end. So a driven body gets
// its pose at the end of the step.
class Drives {
  public:
    // Where a body is to be at the end of the step to come.
    void add(btRigidBody *body, const btTransform &end) { drives_.push_back({body, end}); }
    void remove(const btRigidBody *body);
    // A body that is driven, or null.
    const btRigidBody *first() const { return drives_.empty() ? nullptr : drives_.front().body; }

    // Bullet takes the velocity of a driven body from where it was a step ago
    // (btRigidBody.cpp, saveKinematicState, 3.24), which is told so that the
    // velocity is that of the way to come.
    void begin_step() const;
    void end_step();

  private:
    struct Drive {
        btRigidBody *body;
        btTransform end;
    };
    std::vector<Drive> drives_;
};

} // namespace pluvia
