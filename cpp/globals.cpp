#include "globals.h"

#include "bodies.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <stdexcept>

namespace pluvia {

namespace {
int holders = 0; // guarded by construction_mutex
} // namespace

std::mutex &construction_mutex() {
    static std::mutex mutex;
    return mutex;
}

GlobalsHold::GlobalsHold(const GlobalSettings &settings) {
    if (holders > 0 && (gDbvtMargin != settings.broadphase_margin ||
                        gContactBreakingThreshold != settings.contact_breaking_threshold)) {
        throw std::runtime_error(
            "Bullet keeps the contact threshold and the broadphase margin once for the whole "
            "process, and another world with other values is alive");
    }
    // Written by the first alone: the others' threads may be reading.
    if (holders++ == 0) {
        gDbvtMargin = settings.broadphase_margin;
        gCalculateCombinedFrictionCallback = &combined_friction;
        gCalculateCombinedRestitutionCallback = &combined_restitution;
        gContactBreakingThreshold = settings.contact_breaking_threshold;
    }
}

GlobalsHold::~GlobalsHold() { --holders; }

} // namespace pluvia
