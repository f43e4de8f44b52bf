// Pluvia's hull–hull test in Bullet's dispatcher.
#pragma once

#include "contact_memory.h"
#include "hull_bodies.h"
#include "hull_pair.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pluvia {

// What all pairs of a world share.
struct HullCollision {
    PairSettings settings;
    btScalar match; // distance up to which points of successive steps are taken for the same
    const AxisKernels *kernels;
    btScalar step = 0;         // length of a step, for which fast pairs are foreseen
    RecalledContacts recalled; // for new manifolds of the first step
    HullBodies bodies;         // of this step
};

// Settings for a world: `reach` is the gap up to which contact points are
// kept; both in engine units, `scale` in engine units per metre.
PairSettings pair_settings(double reach, double scale);
btScalar match_distance(double scale);

// One step of a pair: from the poses, and what pair and manifold remember, to
// the points in the manifold.
void collide_into(HullCollision &shared, const HullData &a, const HullData &b,
                  const btTransform &pose_a, const btTransform &pose_b, PairMemory &memory,
                  PairScratch &scratch, btPersistentManifold &manifold);

// Asks the memory for what will be read soon.
void prefetch(const void *from, std::size_t bytes);

// One for each pair in the broadphase; holds the pair's memory, and its
// manifold while there are contact points.
class HullAlgorithm final : public btCollisionAlgorithm {
  public:
    HullAlgorithm(const btCollisionAlgorithmConstructionInfo &info, HullCollision &shared)
        : btCollisionAlgorithm(info), shared_(shared) {}
    ~HullAlgorithm() override;

    void processCollision(const btCollisionObjectWrapper *a, const btCollisionObjectWrapper *b,
                          const btDispatcherInfo &info, btManifoldResult *result) override;
    // Bodies are not swept: the step ends where contacts begin.
    btScalar calculateTimeOfImpact(btCollisionObject *, btCollisionObject *,
                                   const btDispatcherInfo &, btManifoldResult *) override {
        return 1;
    }
    void getAllContactManifolds(btManifoldArray &manifolds) override;

    // Finds the contact of the pair; both shapes are TightHulls. Writes only
    // what belongs to the pair. True where its manifold must come, for the
    // points in `contact`, or go: then `change` has to be called.
    bool find(const HullBody &a, const HullBody &b, PairScratch &scratch, PairContact &contact);
    // Makes or releases the manifold; not from several threads at once.
    void change(const HullBody &a, const HullBody &b, const PairContact &contact);
    bool holds_contacts() const { return manifold_ != nullptr; }

    // Asks for what `find` will read, while something else is done.
    void prefetch() const;
    void prefetch_points() const;

  private:
    HullCollision &shared_;
    btPersistentManifold *manifold_ = nullptr;
    PairMemory memory_;

    void release();
    void write(const HullBody &a, const HullBody &b, const PairContact &contact);
};

// Makes the algorithm; register it for (CONVEX_HULL, CONVEX_HULL) where every
// such shape is a TightHull. The pool of collision algorithms must have
// elements of sizeof(HullAlgorithm) at least
// (btDefaultCollisionConstructionInfo::m_customCollisionAlgorithmMaxElementSize).
class HullCreateFunc final : public btCollisionAlgorithmCreateFunc {
  public:
    explicit HullCreateFunc(HullCollision &shared) : shared_(shared) {}
    btCollisionAlgorithm *CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo &info,
                                                   const btCollisionObjectWrapper *a,
                                                   const btCollisionObjectWrapper *b) override;

  private:
    HullCollision &shared_;
};

} // namespace pluvia
