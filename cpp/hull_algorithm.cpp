#include "hull_algorithm.h"

#include "pluvia/src/world/bullet/ffi.rs.h"
#include "prefetch.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>
#include <new>

namespace pluvia {

namespace {

std::uint32_t place(const btCollisionObject &body) {
    return static_cast<std::uint32_t>(HullBodies::index(*body.getBroadphaseHandle()));
}

} // namespace

PairSettings pair_settings(const Tolerances &tolerances, double scale) {
    return {tolerances.contact_margin * scale, 0, tolerances.hysteresis * scale,
            tolerances.hold * scale, tolerances.face_preference * scale};
}

void HullCollision::forget(const btCollisionObject &body) {
    touching.erase(std::remove_if(touching.begin(), touching.end(),
                                  [&body](const Touching &pair) {
                                      return pair.a->object == &body || pair.b->object == &body;
                                  }),
                   touching.end());
}

void HullAlgorithm::ask_for_hulls(const HullData &a, const HullData &b) const {
    const PairMemory &memory = state_.memory;
    const bool edges = memory.feature == Feature::Edges;
    if (edges || (memory.feature == Feature::None && memory.has_axis)) {
        prefetch(a.vx, a.vz + a.vertices);
        prefetch(b.vx, b.vz + b.vertices);
    }
    if (edges) {
        a.prefetch_edge(memory.first);
        b.prefetch_edge(memory.second);
        prefetch(a.nx, a.nz + a.faces);
    }
}

void HullAlgorithm::find(const HullBody &a, const HullBody &b, double travelled,
                         PairScratch &scratch) {
    PairSettings settings = shared_.settings;
    settings.approach = approach_in_step(a, b, shared_.step);
    settings.reach += settings.approach;
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(*a.object, *b.object, *a.hull, *b.hull, state_);
    }
    PairContact contact;
    const PairMotion motion{a.motion, b.motion, shared_.step};
    collide(*shared_.kernels, *a.hull, *b.hull, a.pose, b.pose, motion, settings, state_.memory,
            scratch, contact);
    take_contact(contact, shared_.match, state_);
    points_ = contact.count;
    const PairMemory &memory = state_.memory;
    apart_until_ = memory.feature == Feature::None && memory.has_axis
                       ? travelled + static_cast<double>(memory.widest)
                       : -1;
}

HullAlgorithm::HullAlgorithm(const btCollisionAlgorithmConstructionInfo &info,
                             HullCollision &shared, const btCollisionObject *a,
                             const btCollisionObject *b)
    : btCollisionAlgorithm(info), shared_(shared), at_a_(place(*a)), at_b_(place(*b)) {
    state_.friction = static_cast<float>(gCalculateCombinedFrictionCallback(a, b));
    state_.restitution = static_cast<float>(gCalculateCombinedRestitutionCallback(a, b));
}

btCollisionAlgorithm *
HullCreateFunc::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo &info,
                                         const btCollisionObjectWrapper *a,
                                         const btCollisionObjectWrapper *b) {
    void *memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(HullAlgorithm));
    return new (memory)
        HullAlgorithm(info, shared_, a->getCollisionObject(), b->getCollisionObject());
}

} // namespace pluvia
