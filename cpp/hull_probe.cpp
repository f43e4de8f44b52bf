#include "hull_probe.h"

#include "bodies.h"
#include "hull_manifold.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "shapes.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace pluvia {

namespace {

// Pluvia's hooks for the coefficients look up a table; one material will do.
Materials &materials() {
    static Materials table{1, {PairValue{0.5, 0.25}}};
    return table;
}

} // namespace

HullProbe::HullProbe(double scale, double reach, bool portable, std::unique_ptr<const HullData> a,
                     std::unique_ptr<const HullData> b)
    : units_(scale), a_(std::move(a)), b_(std::move(b)),
      manifold_(&body_a_, &body_b_, 0, units_.length(reach), units_.length(reach)) {
    collision_.settings = pair_settings(reach * scale, scale);
    collision_.match = match_distance(scale);
    collision_.kernels = portable ? &portable_axis_kernels() : &axis_kernels();
    for (btCollisionObject *body : {&body_a_, &body_b_}) {
        body->setUserIndex2(0);
        body->setUserPointer(&materials());
    }
}

rust::Vec<HullProbePoint> HullProbe::step(const HullProbePose &a, const HullProbePose &b) {
    const btTransform pose_a = units_.pose(a.position, a.rotation);
    const btTransform pose_b = units_.pose(b.position, b.rotation);
    collide_into(collision_, *a_, *b_, pose_a, pose_b, memory_, scratch_, manifold_);
    rust::Vec<HullProbePoint> out;
    for (int i = 0; i < manifold_.getNumContacts(); ++i) {
        const btManifoldPoint &p = manifold_.getContactPoint(i);
        HullProbePoint point{};
        point.gap = units_.metres(p.m_distance1);
        point.normal = array(p.m_normalWorldOnB);
        point.on_a = units_.metres(p.m_positionWorldOnA);
        point.on_b = units_.metres(p.m_positionWorldOnB);
        point.id = static_cast<std::uint32_t>(p.m_index0);
        point.age = p.m_lifeTime;
        point.impulse = units_.metres(p.m_appliedImpulse);
        point.friction = units_.metres(p.m_lateralFrictionDir1 * p.m_appliedImpulseLateral1 +
                                       p.m_lateralFrictionDir2 * p.m_appliedImpulseLateral2);
        out.push_back(point);
    }
    return out;
}

void HullProbe::set_impulse(std::size_t point, double normal,
                            const std::array<double, 3> &friction) {
    if (point >= static_cast<std::size_t>(manifold_.getNumContacts())) {
        throw std::runtime_error("the pair has no such contact point");
    }
    btManifoldPoint &p = manifold_.getContactPoint(static_cast<int>(point));
    p.m_appliedImpulse = units_.length(normal);
    const btVector3 vector = units_.length(friction);
    const btScalar size = vector.length();
    p.m_lateralFrictionDir1 = size > 0 ? vector / size : btVector3(0, 0, 0);
    p.m_appliedImpulseLateral1 = size;
    p.m_lateralFrictionDir2 = btVector3(0, 0, 0);
    p.m_appliedImpulseLateral2 = 0;
}

void HullProbe::forget() {
    memory_ = PairMemory();
    manifold_.setNumContacts(0);
}

HullProbeGap HullProbe::widest_gap(const HullProbePose &a, const HullProbePose &b, bool all_edges) {
    const Rigid pose_a = rigid(units_.pose(a.position, a.rotation));
    const Rigid pose_b = rigid(units_.pose(b.position, b.rotation));
    const Rigid relative = Rigid::between(pose_b, pose_a);
    Relative pose;
    std::copy(relative.r, relative.r + 9, pose.r);
    std::copy(relative.t, relative.t + 3, pose.t);
    AxisScratch &scratch = scratch_.axis;
    scratch.fit(*a_, *b_);
    FaceGaps faces;
    collision_.kernels->faces(*a_, *b_, pose, scratch, faces);
    const bool is_a = faces.gap_a >= faces.gap_b;
    double gap = is_a ? faces.gap_a : faces.gap_b;
    double axis[3];
    if (is_a) {
        axis[0] = a_->nx[faces.face_a], axis[1] = a_->ny[faces.face_a],
        axis[2] = a_->nz[faces.face_a];
    } else {
        axis[0] = -scratch.bnx[faces.face_b], axis[1] = -scratch.bny[faces.face_b],
        axis[2] = -scratch.bnz[faces.face_b];
    }
    const auto reach = static_cast<float>(collision_.settings.reach);
    const auto best = static_cast<float>(gap);
    EdgeGap edges;
    collision_.kernels->edges(*a_, *b_, pose, faces, best, 1e30F,
                              all_edges ? -1 : std::max(reach, -best), scratch, edges);
    if (edges.edge_a >= 0) {
        gap = edges.gap;
        std::copy(edges.axis, edges.axis + 3, axis);
    }
    double world[3];
    pose_a.turn(axis, world);
    return {gap / units_.scale(), {world[0], world[1], world[2]}, edges.edge_a >= 0};
}

double HullProbe::time_steps(rust::Slice<const HullProbePose> poses, std::size_t rounds,
                             bool remember) {
    btTransform origin;
    origin.setIdentity();
    std::vector<btTransform> moved;
    for (const HullProbePose &pose : poses) {
        moved.push_back(units_.pose(pose.position, pose.rotation));
    }
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t round = 0; round < rounds; ++round) {
        for (const btTransform &pose : moved) {
            if (!remember) {
                forget();
            }
            collide_into(collision_, *a_, *b_, origin, pose, memory_, scratch_, manifold_);
        }
    }
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
    return spent.count() / static_cast<double>(rounds * std::max<std::size_t>(1, moved.size()));
}

namespace {

std::unique_ptr<const HullData> hull(double scale, const HullProbeShape &shape) {
    return make_hull_data(Units(scale), {shape.coordinates.data(), shape.coordinates.size() / 3,
                                         shape.face_starts.data(), shape.face_starts.size() - 1,
                                         shape.face_vertices.data()});
}

} // namespace

std::unique_ptr<HullProbe> new_hull_probe(double scale, double reach, bool portable,
                                          const HullProbeShape &a, const HullProbeShape &b) {
    return std::make_unique<HullProbe>(scale, reach, portable, hull(scale, a), hull(scale, b));
}

} // namespace pluvia
