// Bullet's world where Pluvia finds the contacts and solves them.
#pragma once

#include "contact_solver.h"
#include "hull_dispatcher.h"
#include "phased_world.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

namespace pluvia {

// Differs from Bullet's in three things, none of which any contact hangs on.
//
// The boxes in the broadphase are larger than the bodies, so that a body takes
// a new one only when it has left the old, and they are counted from a place
// that moves along with the apparatus, so that shaking alone lets none leave.
//
// Bullet looks for no islands: all contacts go to the solver in one call, and
// the solver puts them in an order of its own (contact_colours.h).
//
// Passes over all bodies are left out that would find nothing to do: none is
// swept, sleeps, has a motion state or, without damping, is slowed down. The
// solver, which has the bodies at hand, gives them their weight and moves them.
class HullWorld final : public PhasedWorld {
  public:
    // Lengths in engine units; `collision` must outlive the world. `damped`:
    // whether any body has damping.
    HullWorld(HullDispatcher *dispatcher, btDbvtBroadphase *broadphase, ContactSolver &solver,
              btCollisionConfiguration *configuration, HullCollision &collision, btScalar slack,
              bool damped)
        : PhasedWorld(dispatcher, broadphase, &solver, configuration), boxes_(*broadphase),
          collision_(collision), solver_(solver), slack_(slack), damped_(damped) {}

    using PhasedWorld::addRigidBody;
    void addRigidBody(btRigidBody *body, int group, int mask) override;
    void removeRigidBody(btRigidBody *body) override;

    // The body that boxes move along with from now on; null for none.
    void follow(const btRigidBody *body);
    const btRigidBody *followed() const { return followed_; }

  protected:
    void renew_boxes() override;
    void calculateSimulationIslands() override {}
    void solve(btContactSolverInfo &info) override;
    void saveKinematicState(btScalar step) override;
    void predictUnconstraintMotion(btScalar step) override;
    void integrateTransforms(btScalar step) override;
    void createPredictiveContacts(btScalar) override {}
    void updateActivationState(btScalar) override {}
    void synchronizeMotionStates() override {}
    void applyGravity() override {}
    void clearForces() override {}

  private:
    btDbvtBroadphase &boxes_;
    HullCollision &collision_;
    ContactSolver &solver_;
    btScalar slack_;
    bool damped_;
    const btRigidBody *followed_ = nullptr;
    btVector3 start_{0, 0, 0}; // where the place would be had the body not moved from the origin

    btVector3 place() const;
};

} // namespace pluvia
