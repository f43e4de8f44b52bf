#include "globals.h"

#include "bodies.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <stdexcept>

namespace pluvia {

namespace {
// Guarded by construction_mutex.
int holders = 0;
int threshold_holders = 0;
} // namespace

std::mutex &construction_mutex() {
    static std::mutex mutex;
    return mutex;
}

GlobalsHold::GlobalsHold(const GlobalSettings &settings)
    : reads_threshold_(settings.contact_breaking_threshold >= 0) {
    const bool other_margin = holders > 0 && gDbvtMargin != settings.broadphase_margin;
    const bool other_threshold = reads_threshold_ && threshold_holders > 0 &&
                                 gContactBreakingThreshold != settings.contact_breaking_threshold;
    if (other_margin || other_threshold) {
        throw std::runtime_error(
            "Bullet keeps the contact threshold and the broadphase margin once for the whole "
            "process, and another world with other values is alive");
    }
    // Written by the first alone: the others' threads may be reading.
    if (holders++ == 0) {
        gDbvtMargin = settings.broadphase_margin;
        gCalculateCombinedFrictionCallback = &combined_friction;
        gCalculateCombinedRestitutionCallback = &combined_restitution;
    }
    if (reads_threshold_ && threshold_holders++ == 0) {
        gContactBreakingThreshold = settings.contact_breaking_threshold;
    }
}

GlobalsHold::~GlobalsHold() {
    --holders;
    threshold_holders -= reads_threshold_ ? 1 : 0;
}

GlobalSettings GlobalsHold::read_back() { return {gContactBreakingThreshold, gDbvtMargin}; }

} // namespace pluvia
