#include "hull_algorithm.h"

#include "hull_manifold.h"
#include "shapes.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <new>

namespace pluvia {

namespace {

// Found by experiment on packings at rest: with 0.005 to 0.05 mm they stay at
// rest, with 0 they creep.
constexpr double HYSTERESIS = 0.02e-3; // m

// A quarter of that: enough to tell a face from edges that lie on it within
// rounding, too little to be felt as depth.
constexpr double FACE_PREFERENCE = 0.005e-3; // m

// A tenth of a grain: contact points of one pair are further apart than that,
// and none travels so far in a step.
constexpr double MATCH = 1e-3; // m

} // namespace

Rigid rigid(const btTransform &pose) {
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] = static_cast<double>(pose.getBasis()[i][j]);
        }
        out.t[i] = static_cast<double>(pose.getOrigin()[i]);
    }
    return out;
}

PairSettings pair_settings(double reach, double scale) {
    return {reach, HYSTERESIS * scale, FACE_PREFERENCE * scale};
}

btScalar match_distance(double scale) { return static_cast<btScalar>(MATCH * scale); }

void collide_into(HullCollision &shared, const HullData &a, const HullData &b,
                  const btTransform &pose_a, const btTransform &pose_b, PairMemory &memory,
                  PairScratch &scratch, btPersistentManifold &manifold) {
    PairContact contact;
    collide(*shared.kernels, a, b, rigid(pose_a), rigid(pose_b), shared.settings, memory, scratch,
            contact);
    write_manifold(contact, pose_a, pose_b, shared.match, manifold);
}

btScalar approach_in_step(const btCollisionObject &a, const btCollisionObject &b, btScalar step) {
    const btRigidBody *body_a = btRigidBody::upcast(&a);
    const btRigidBody *body_b = btRigidBody::upcast(&b);
    const auto turning = [](const btRigidBody &body) {
        return body.getAngularVelocity().length() *
               static_cast<const TightHull *>(body.getCollisionShape())->radius();
    };
    const btVector3 relative = body_a->getLinearVelocity() - body_b->getLinearVelocity();
    return step * (relative.length() + turning(*body_a) + turning(*body_b));
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
    const btCollisionObject &a = *on_a->getCollisionObject();
    const btCollisionObject &b = *on_b->getCollisionObject();
    PairScratch scratch;
    PairContact contact;
    if (find(a, b, scratch, contact)) {
        change(a, b, contact);
    }
}

bool HullAlgorithm::find(const btCollisionObject &a, const btCollisionObject &b,
                         PairScratch &scratch, PairContact &contact) {
    const auto &hull_a = static_cast<const TightHull *>(a.getCollisionShape())->data();
    const auto &hull_b = static_cast<const TightHull *>(b.getCollisionShape())->data();
    const btTransform &pose_a = a.getWorldTransform();
    const btTransform &pose_b = b.getWorldTransform();
    PairSettings settings = shared_.settings;
    settings.reach += static_cast<double>(approach_in_step(a, b, shared_.step));
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(a, b, hull_a, hull_b, memory_);
    }
    collide(*shared_.kernels, hull_a, hull_b, rigid(pose_a), rigid(pose_b), settings, memory_,
            scratch, contact);
    if (contact.count == 0 || manifold_ == nullptr) {
        return (contact.count > 0) != (manifold_ != nullptr);
    }
    write_manifold(contact, pose_a, pose_b, shared_.match, *manifold_);
    return false;
}

void HullAlgorithm::change(const btCollisionObject &a, const btCollisionObject &b,
                           const PairContact &contact) {
    if (contact.count == 0) {
        release();
        return;
    }
    manifold_ = m_dispatcher->getNewManifold(&a, &b);
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(*manifold_);
    }
    write_manifold(contact, a.getWorldTransform(), b.getWorldTransform(), shared_.match,
                   *manifold_);
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
