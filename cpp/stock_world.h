// Bullet's world as it comes: its contacts, its solver, its rules.
#pragma once

#include "engine_world.h"
#include "globals.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

namespace pluvia {

// What the world is made of; it must be there before it, and after.
struct StockParts {
    StockParts(const Units &units, const WorldDefinition &definition);

    // Bullet falls back to the heap when a pool is full, which is slow. A
    // dense specimen of 1456 grains holds about 20 000 pairs.
    static constexpr int PAIRS = 32768;

    GlobalsHold globals;
    btDefaultCollisionConfiguration configuration{pool_sizes(PAIRS)};
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase boxes;
    btSequentialImpulseConstraintSolver solver;
};

// Made for comparison with Bullet as others use it, so nothing of its step is
// Pluvia's: it calls back for the coefficients of pairs, leaves out pairs that
// cannot touch, and tells its time. What other programs leave to Bullet can be
// asked for: sleep, moments of inertia of bounding boxes, a least mass.
class StockWorld final : private StockParts, public EngineWorld {
  public:
    // `materials` must outlive the world. Three of Bullet's settings are only read back, its
    // defaults being left alone: the turn ERP of split impulses, the smallest batch, and the
    // restitution of speculative contacts.
    StockWorld(const Units &units, const WorldDefinition &definition, Materials &materials);

    BodyDefinition applied(const BodyDefinition &definition,
                           const btCollisionShape &shape) override;
    double largest_inertia_ratio() const override { return largest_inertia_ratio_; }
    // A kinematic body that stands still is asleep from the beginning, where bodies
    // fall asleep: awake, it would keep all awake that touch it.
    void add(btRigidBody &body, BodyKind kind) override;
    // It wakes when it moves, and sleeps again when it is to stay where it is.
    void drive(btRigidBody &body, const btTransform &end) override;
    void step(btScalar length) override;
    void read_contacts(rust::Vec<ContactRead> &out) const override;
    // Through the hooks, as Bullet does when it makes a contact.
    PairValue pair_value(const btRigidBody &a, const btRigidBody &b) const override;
    void read_settings(ReadBack &out) const override;
    void read_body(const btRigidBody &body, ReadBack &out) const override;

    // Bullet's, timed.
    void performDiscreteCollisionDetection() override;
    void updateAabbs() override;
    void computeOverlappingPairs() override;

  protected:
    void solveConstraints(btContactSolverInfo &info) override;

  private:
    Units units_;
    Materials &materials_;
    const WorldDefinition definition_;
    double largest_inertia_ratio_ = 1;
};

} // namespace pluvia
