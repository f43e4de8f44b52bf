#include "globals.h"

#include "bodies.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <stdexcept>

namespace pluvia {

namespace {
int holders = 0; // guarded by construction_mutex
}

std::mutex &construction_mutex() {
    static std::mutex mutex;
    return mutex;
}

GlobalsHold::GlobalsHold(const GlobalSettings &settings) {
    if (holders == 0) {
        gContactBreakingThreshold = settings.contact_breaking_threshold;
        gDbvtMargin = settings.broadphase_margin;
        gCalculateCombinedFrictionCallback = &combined_friction;
        gCalculateCombinedRestitutionCallback = &combined_restitution;
    } else if (gContactBreakingThreshold != settings.contact_breaking_threshold ||
               gDbvtMargin != settings.broadphase_margin) {
        throw std::runtime_error(
            "Bullet keeps the contact threshold and the broadphase margin once for the whole "
            "process, and another world with other values is alive");
    }
    ++holders;
}

GlobalsHold::~GlobalsHold() { --holders; }

GlobalSettings GlobalsHold::read_back() { return {gContactBreakingThreshold, gDbvtMargin}; }

} // namespace pluvia
