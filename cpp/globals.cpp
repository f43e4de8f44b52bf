// Sets the variables that Bullet keeps once per process, its hooks for the friction and restitution
// of a pair among them, and refuses worlds that would need other values.
#include "globals.h"

#include "bodies.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <stdexcept>

namespace pluvia {

namespace {

int holders = 0; // guarded by construction_mutex

const PairValue &pair_value(const btCollisionObject *a, const btCollisionObject *b) {
    return static_cast<const Materials *>(a->getUserPointer())
        ->of(a->getUserIndex(), b->getUserIndex());
}

// Bullet's hooks for the coefficients of a pair (btManifoldResult.h). They
// stand in for Bullet's rule, which multiplies one value of each body, and find
// the materials behind the user pointer of the first.
btScalar combined_friction(const btCollisionObject *a, const btCollisionObject *b) {
    return static_cast<btScalar>(pair_value(a, b).friction);
}

btScalar combined_restitution(const btCollisionObject *a, const btCollisionObject *b) {
    return static_cast<btScalar>(pair_value(a, b).restitution);
}

} // namespace

std::mutex &construction_mutex() {
    static std::mutex mutex;
    return mutex;
}

GlobalsHold::GlobalsHold(btScalar contact_breaking_threshold, btScalar broadphase_margin) {
    if (holders > 0 && (gDbvtMargin != broadphase_margin ||
                        gContactBreakingThreshold != contact_breaking_threshold)) {
        throw std::runtime_error(
            "Bullet keeps the contact threshold and the broadphase margin once for the whole "
            "process, and another world with other values is alive");
    }
    // Written by the first alone: the others' threads may be reading.
    if (holders++ == 0) {
        gDbvtMargin = broadphase_margin;
        gCalculateCombinedFrictionCallback = &combined_friction;
        gCalculateCombinedRestitutionCallback = &combined_restitution;
        gContactBreakingThreshold = contact_breaking_threshold;
    }
}

GlobalsHold::~GlobalsHold() { --holders; }

} // namespace pluvia
