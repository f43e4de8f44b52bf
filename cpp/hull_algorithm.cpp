#include "hull_algorithm.h"

#include "hull_manifold.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <new>

namespace pluvia {

namespace {

// Found by experiment on packings at rest: with 0.005 to 0.05 mm they stay at
// rest, with 0 they creep.
constexpr double HYSTERESIS = 0.02e-3; // m

// A quarter of that: less than what features may differ by and be kept.
constexpr double HOLD = 0.02e-3; // m

// A quarter as well: enough to tell a face from edges that lie on it within
// rounding, too little to be felt as depth.
constexpr double FACE_PREFERENCE = 0.005e-3; // m

// A tenth of a grain: contact points of one pair are further apart than that,
// and none travels so far in a step.
constexpr double MATCH = 1e-3; // m

} // namespace

void prefetch(const void *from, std::size_t bytes) {
    constexpr std::size_t LINE = 64;
    const auto *at = static_cast<const char *>(from);
    for (std::size_t i = 0; i < bytes; i += LINE) {
        __builtin_prefetch(at + i);
    }
}

PairSettings pair_settings(double reach, double scale) {
    return {reach, HYSTERESIS * scale, HOLD * scale, FACE_PREFERENCE * scale};
}

btScalar match_distance(double scale) { return static_cast<btScalar>(MATCH * scale); }

void collide_into(HullCollision &shared, const HullData &a, const HullData &b,
                  const btTransform &pose_a, const btTransform &pose_b, PairMemory &memory,
                  PairScratch &scratch, btPersistentManifold &manifold) {
    PairContact contact;
    collide(*shared.kernels, a, b, rigid(pose_a), rigid(pose_b), shared.settings, memory, scratch,
            contact);
    if (contact.held) {
        refresh_manifold(contact, pose_a, pose_b, manifold);
    } else {
        write_manifold(contact, pose_a, pose_b, shared.match, manifold);
    }
}

HullAlgorithm::~HullAlgorithm() { release(); }

void HullAlgorithm::release() {
    if (manifold_ != nullptr) {
        m_dispatcher->releaseManifold(manifold_);
        manifold_ = nullptr;
    }
}

// Only for who calls it by hand: the dispatcher goes to `find` at once.
void HullAlgorithm::processCollision(const btCollisionObjectWrapper *on_a,
                                     const btCollisionObjectWrapper *on_b, const btDispatcherInfo &,
                                     btManifoldResult *) {
    const HullBody a = hull_body(*on_a->getCollisionObject());
    const HullBody b = hull_body(*on_b->getCollisionObject());
    PairScratch scratch;
    PairContact contact;
    if (find(a, b, scratch, contact)) {
        change(a, b, contact);
    }
}

bool HullAlgorithm::find(const HullBody &a, const HullBody &b, PairScratch &scratch,
                         PairContact &contact) {
    PairSettings settings = shared_.settings;
    settings.reach += approach_in_step(a, b, static_cast<double>(shared_.step));
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(*a.object, *b.object, *a.hull, *b.hull, memory_);
    }
    collide(*shared_.kernels, *a.hull, *b.hull, a.pose, b.pose, settings, memory_, scratch,
            contact);
    if (contact.count == 0 || manifold_ == nullptr) {
        return (contact.count > 0) != (manifold_ != nullptr);
    }
    write(a, b, contact);
    return false;
}

void HullAlgorithm::prefetch() const { pluvia::prefetch(this, sizeof(*this)); }

void HullAlgorithm::prefetch_points() const {
    if (manifold_ != nullptr) {
        pluvia::prefetch(manifold_, sizeof(btManifoldPoint) * 2);
    }
}

void HullAlgorithm::change(const HullBody &a, const HullBody &b, const PairContact &contact) {
    if (contact.count == 0) {
        release();
        return;
    }
    manifold_ = m_dispatcher->getNewManifold(a.object, b.object);
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(*manifold_);
    }
    write(a, b, contact);
}

void HullAlgorithm::write(const HullBody &a, const HullBody &b, const PairContact &contact) {
    const btTransform &pose_a = a.object->getWorldTransform();
    const btTransform &pose_b = b.object->getWorldTransform();
    if (contact.held) {
        refresh_manifold(contact, pose_a, pose_b, *manifold_);
    } else {
        write_manifold(contact, pose_a, pose_b, shared_.match, *manifold_);
    }
}

void HullAlgorithm::getAllContactManifolds(btManifoldArray &manifolds) {
    if (manifold_ != nullptr) {
        manifolds.push_back(manifold_);
    }
}

btCollisionAlgorithm *
HullCreateFunc::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo &info,
                                         const btCollisionObjectWrapper *,
                                         const btCollisionObjectWrapper *) {
    void *memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(HullAlgorithm));
    return new (memory) HullAlgorithm(info, shared_);
}

} // namespace pluvia
