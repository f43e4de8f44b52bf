#include "pairs.h"

#include "shapes.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pluvia {

namespace {

// Bullet has grown both boxes by the contact threshold already
// (btCollisionWorld::updateSingleAabb, 3.24): boxes of bodies within reach
// overlap by at least what both have grown, less the reach.
bool boxes_within_reach(const btBroadphaseProxy &a, const btBroadphaseProxy &b, btScalar reach) {
    const btScalar least = 2 * gContactBreakingThreshold - reach;
    for (int axis = 0; axis < 3; ++axis) {
        if (a.m_aabbMax[axis] - b.m_aabbMin[axis] < least ||
            b.m_aabbMax[axis] - a.m_aabbMin[axis] < least) {
            return false;
        }
    }
    return true;
}

bool spheres_within_reach(const btCollisionObject &a, const btCollisionObject &b, btScalar reach) {
    const auto radius = [](const btCollisionObject &body) {
        return static_cast<const TightHull *>(body.getCollisionShape())->radius();
    };
    const btScalar apart = radius(a) + radius(b) + reach;
    return (a.getWorldTransform().getOrigin() - b.getWorldTransform().getOrigin()).length2() <=
           apart * apart;
}

bool holds_contacts(btCollisionAlgorithm &algorithm) {
    // Kept for its memory: this runs for every pair of every step.
    thread_local btManifoldArray manifolds;
    manifolds.resize(0);
    algorithm.getAllContactManifolds(manifolds);
    for (int i = 0; i < manifolds.size(); ++i) {
        if (manifolds[i]->getNumContacts() > 0) {
            return true;
        }
    }
    return false;
}

// Exact for what it denies: bodies that are not within reach are further apart.
bool within_reach(const btBroadphasePair &pair, btScalar reach) {
    const btBroadphaseProxy &a = *pair.m_pProxy0;
    const btBroadphaseProxy &b = *pair.m_pProxy1;
    return boxes_within_reach(a, b, reach) &&
           spheres_within_reach(*static_cast<const btCollisionObject *>(a.m_clientObject),
                                *static_cast<const btCollisionObject *>(b.m_clientObject), reach);
}

} // namespace

void near_callback(btBroadphasePair &pair, btCollisionDispatcher &dispatcher,
                   const btDispatcherInfo &info) {
    if (within_reach(pair, gContactBreakingThreshold) ||
        (pair.m_algorithm && holds_contacts(*pair.m_algorithm))) {
        btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    }
}

} // namespace pluvia
