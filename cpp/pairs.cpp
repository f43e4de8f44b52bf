#include "pairs.h"

#include "shapes.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pluvia {

namespace {

// Bullet has grown both boxes by the contact threshold already
// (btCollisionWorld::updateSingleAabb, 3.24): boxes of bodies within the speculative margin
// overlap by at least what both have grown, less the speculative margin.
bool boxes_within_margin(const btBroadphaseProxy &a, const btBroadphaseProxy &b, btScalar margin) {
    const btScalar least = 2 * gContactBreakingThreshold - margin;
    for (int axis = 0; axis < 3; ++axis) {
        if (a.m_aabbMax[axis] - b.m_aabbMin[axis] < least ||
            b.m_aabbMax[axis] - a.m_aabbMin[axis] < least) {
            return false;
        }
    }
    return true;
}

bool spheres_within_margin(const btCollisionObject &a, const btCollisionObject &b,
                           btScalar margin) {
    const auto radius = [](const btCollisionObject &body) {
        return bounding_radius(*body.getCollisionShape());
    };
    const btScalar apart = radius(a) + radius(b) + margin;
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

// Exact for what it denies: bodies that are not within the speculative margin are further apart.
bool within_margin(const btBroadphasePair &pair, btScalar margin) {
    const btBroadphaseProxy &a = *pair.m_pProxy0;
    const btBroadphaseProxy &b = *pair.m_pProxy1;
    return boxes_within_margin(a, b, margin) &&
           spheres_within_margin(*static_cast<const btCollisionObject *>(a.m_clientObject),
                                 *static_cast<const btCollisionObject *>(b.m_clientObject), margin);
}

} // namespace

void near_callback(btBroadphasePair &pair, btCollisionDispatcher &dispatcher,
                   const btDispatcherInfo &info) {
    if (within_margin(pair, gContactBreakingThreshold) ||
        (pair.m_algorithm && holds_contacts(*pair.m_algorithm))) {
        btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    }
}

} // namespace pluvia
