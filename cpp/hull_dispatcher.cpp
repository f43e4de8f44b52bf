#include "hull_dispatcher.h"

#include "pairs.h"

namespace pluvia {

namespace {

// As Bullet's near callback, for pairs of hulls only: leaves out what cannot
// touch, and goes straight to the pair's algorithm.
void hull_near_callback(btBroadphasePair &pair, btCollisionDispatcher &dispatcher,
                        const btDispatcherInfo &info) {
    auto *algorithm = static_cast<HullAlgorithm *>(pair.m_algorithm);
    if (algorithm == nullptr || !algorithm->holds_contacts()) {
        const HullCollision &own = *static_cast<HullDispatcher &>(dispatcher).collision();
        const btScalar approach = approach_in_step(
            *static_cast<const btCollisionObject *>(pair.m_pProxy0->m_clientObject),
            *static_cast<const btCollisionObject *>(pair.m_pProxy1->m_clientObject), own.step);
        if (!within_reach(pair, static_cast<btScalar>(own.settings.reach) + approach)) {
            return;
        }
    }
    if (algorithm == nullptr) {
        btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
        return;
    }
    const auto *a = static_cast<const btCollisionObject *>(pair.m_pProxy0->m_clientObject);
    const auto *b = static_cast<const btCollisionObject *>(pair.m_pProxy1->m_clientObject);
    if (dispatcher.needsCollision(a, b)) {
        algorithm->update(*a, *b);
    }
}

} // namespace

HullDispatcher::HullDispatcher(btCollisionConfiguration *configuration, HullCollision *collision)
    : btCollisionDispatcher(configuration), collision_(collision) {
    if (collision_ == nullptr) {
        setNearCallback(&near_callback);
        return;
    }
    create_ = std::make_unique<HullCreateFunc>(*collision_);
    registerCollisionCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE,
                                create_.get());
    setNearCallback(&hull_near_callback);
}

} // namespace pluvia
