// Finds the contact of one pair by the test that fits its shapes, and keeps what the pair carries
// to the next step.
#include "hull_algorithm.h"

#include "pluvia/src/world/bullet/ffi.rs.h"
#include "pool.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace pluvia {

HullCollision::HullCollision(const Tolerances &t, double scale, bool portable)
    : settings{t.contact_margin * scale, 0, t.hysteresis * scale, t.hold * scale,
               t.face_preference * scale},
      match(t.match_distance * scale), kernels(&axis_kernels(portable)) {}

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

double collide(const PairCase &pair) {
    if (pair.a.is_sphere() || pair.b.is_sphere()) {
        return collide_sphere(pair);
    }
    return pair.a.is_rounded() || pair.b.is_rounded() ? collide_rounded(pair) : collide_hulls(pair);
}

void HullAlgorithm::find(const HullBody &a, const HullBody &b, double travelled,
                         PairScratch &scratch) {
    PairSettings settings = shared_.settings;
    settings.approach = approach_in_step(a, b, shared_.step);
    settings.speculative_margin += settings.approach;
    if (!shared_.recalled.empty()) {
        shared_.recalled.give(a, b, state_);
    }
    PairContact contact;
    const PairMotion motion{a.motion, b.motion, shared_.step};
    PairCase pair{*shared_.kernels, *a.hull,  *b.hull,       a.pose,  b.pose,
                  motion,           settings, state_.memory, scratch, contact};
    // Else the bodies themselves, far away in memory, are not looked at.
    if (!a.hull->is_plain() || !b.hull->is_plain()) {
        const auto of = [](const HullBody &body) {
            return static_cast<double>(btRigidBody::upcast(body.object)->getInvMass());
        };
        pair.lightness = {of(a), of(b)};
    }
    apart_until_ = travelled + collide(pair);
    take_contact(contact, shared_.match, state_);
    points_ = contact.count;
}

HullAlgorithm::HullAlgorithm(HullCollision &shared, const PairValue &value, std::size_t at_a,
                             std::size_t at_b)
    : shared_(shared), at_a_(static_cast<std::uint32_t>(at_a)),
      at_b_(static_cast<std::uint32_t>(at_b)) {
    state_.friction = static_cast<float>(value.friction);
    state_.restitution = static_cast<float>(value.restitution);
}

} // namespace pluvia
