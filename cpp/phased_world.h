// Bullet's world, with a clock for the parts of a step.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace pluvia {

// Wall time in s since the world was made.
struct Phases {
    double broadphase = 0; // boxes and candidate pairs
    double collision = 0;  // contacts of the candidate pairs
    double solver = 0;
    double integration = 0; // everything else
};

class PhasedWorld : public btDiscreteDynamicsWorld {
  public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

    const Phases &phases() const { return phases_; }

    int stepSimulation(btScalar step, int most_substeps, btScalar fixed_step) override;
    void performDiscreteCollisionDetection() override;
    void updateAabbs() final;
    void computeOverlappingPairs() override;

  protected:
    void solveConstraints(btContactSolverInfo &info) final;

    virtual void renew_boxes() { btDiscreteDynamicsWorld::updateAabbs(); }
    virtual void solve(btContactSolverInfo &info) {
        btDiscreteDynamicsWorld::solveConstraints(info);
    }

  private:
    Phases phases_;
};

} // namespace pluvia
