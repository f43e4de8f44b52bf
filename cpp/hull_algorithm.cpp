#include "hull_algorithm.h"

#include "pluvia/src/world/bullet/ffi.rs.h"
#include "prefetch.h"
#include "rounded_pair.h"
#include "sphere_pair.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace pluvia {

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

namespace {

double lightness_of(const HullBody &body) {
    return static_cast<double>(btRigidBody::upcast(body.object)->getInvMass());
}

} // namespace

void HullAlgorithm::find(const HullBody &a, const HullBody &b, double travelled,
                         PairScratch &scratch) {
    PairSettings settings = shared_.settings;
    settings.approach = approach_in_step(a, b, shared_.step);
    settings.speculative_margin += settings.approach;
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(*a.object, *b.object, *a.hull, *b.hull, state_);
    }
    PairContact contact;
    const PairMotion motion{a.motion, b.motion, shared_.step};
    const bool sphere = a.hull->is_sphere() || b.hull->is_sphere();
    if (sphere || a.hull->is_rounded() || b.hull->is_rounded()) {
        const Lightness lightness{lightness_of(a), lightness_of(b)};
        const double gap =
            sphere ? collide_sphere(*a.hull, *b.hull, a.pose, b.pose, motion, lightness, settings,
                                    contact)
                   : collide_rounded(*shared_.kernels, *a.hull, *b.hull, a.pose, b.pose, motion,
                                     lightness, settings, state_.memory, scratch, contact);
        take_contact(contact, shared_.match, state_);
        points_ = contact.count;
        apart_until_ = points_ == 0 ? travelled + gap : -1;
        return;
    }
    collide(*shared_.kernels, *a.hull, *b.hull, a.pose, b.pose, motion, settings, state_.memory,
            scratch, contact);
    take_contact(contact, shared_.match, state_);
    points_ = contact.count;
    const PairMemory &memory = state_.memory;
    apart_until_ = memory.feature == Feature::None && memory.has_axis
                       ? travelled + static_cast<double>(memory.widest)
                       : -1;
}

HullAlgorithm::HullAlgorithm(HullCollision &shared, const PairValue &value, std::size_t at_a,
                             std::size_t at_b)
    : shared_(shared), at_a_(static_cast<std::uint32_t>(at_a)),
      at_b_(static_cast<std::uint32_t>(at_b)) {
    state_.friction = static_cast<float>(value.friction);
    state_.restitution = static_cast<float>(value.restitution);
}

} // namespace pluvia
