#include "hull_probe.h"

#include "pluvia/src/world/bullet/ffi.rs.h"
#include "rounded_pair.h"
#include "shapes.h"
#include "sphere_pair.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace pluvia {

HullProbe::HullProbe(double scale, const Tolerances &tolerances, bool portable,
                     std::unique_ptr<const HullData> a, std::unique_ptr<const HullData> b)
    : units_(scale), a_(std::move(a)), b_(std::move(b)) {
    collision_.settings = pair_settings(tolerances, scale);
    collision_.match = tolerances.match_distance * scale;
    collision_.kernels = portable ? &portable_axis_kernels() : &axis_kernels();
}

rust::Vec<HullProbePoint> HullProbe::step(const HullProbePose &a, const HullProbePose &b) {
    const Rigid pose_a = rigid(units_.pose(a.position, a.rotation));
    const Rigid pose_b = rigid(units_.pose(b.position, b.rotation));
    find(pose_a, pose_b);
    const KeptContact &contact = state_.memory.last;
    const btVector3 normal(static_cast<btScalar>(-contact.normal[0]),
                           static_cast<btScalar>(-contact.normal[1]),
                           static_cast<btScalar>(-contact.normal[2]));
    const auto metres = [this](const double x[3]) {
        return std::array<double, 3>{x[0] / units_.scale(), x[1] / units_.scale(),
                                     x[2] / units_.scale()};
    };
    rust::Vec<HullProbePoint> out;
    for (int i = 0; i < contact.count; ++i) {
        const KeptPoint &p = contact.points[i];
        const Load &load = state_.loads[i];
        double on_a[3], on_b[3], rubbed[3];
        pose_a.apply(p.on_a, on_a);
        pose_b.apply(p.on_b, on_b);
        double pressed = 0;
        for (int k = 0; k < 3; ++k) {
            pressed -=
                static_cast<double>(load.impulse[k]) * static_cast<double>(contact.normal[k]);
        }
        for (int k = 0; k < 3; ++k) {
            rubbed[k] = static_cast<double>(load.impulse[k]) +
                        pressed * static_cast<double>(contact.normal[k]);
        }
        HullProbePoint point{};
        point.gap = static_cast<double>(p.gap) / units_.scale();
        point.normal = array(normal);
        point.on_a = metres(on_a);
        point.on_b = metres(on_b);
        point.id = p.id;
        point.age = load.age;
        point.impulse = pressed / units_.scale();
        point.friction = metres(rubbed);
        out.push_back(point);
    }
    return out;
}

void HullProbe::find(const Rigid &pose_a, const Rigid &pose_b) {
    PairContact contact;
    if (a_->is_sphere() || b_->is_sphere()) {
        collide_sphere(*a_, *b_, pose_a, pose_b, PairMotion{}, Lightness{1, 1}, collision_.settings,
                       contact);
        take_contact(contact, collision_.match, state_);
        return;
    }
    if (a_->is_rounded() || b_->is_rounded()) {
        collide_rounded(*collision_.kernels, *a_, *b_, pose_a, pose_b, PairMotion{},
                        Lightness{1, 1}, collision_.settings, state_.memory, scratch_, contact);
        take_contact(contact, collision_.match, state_);
        return;
    }
    collide(*collision_.kernels, *a_, *b_, pose_a, pose_b, PairMotion{}, collision_.settings,
            state_.memory, scratch_, contact);
    take_contact(contact, collision_.match, state_);
}

void HullProbe::set_impulse(std::size_t point, double normal,
                            const std::array<double, 3> &friction) {
    const KeptContact &contact = state_.memory.last;
    if (point >= static_cast<std::size_t>(contact.count)) {
        throw std::runtime_error("the pair has no such contact point");
    }
    for (std::size_t k = 0; k < 3; ++k) {
        state_.loads[point].impulse[k] = static_cast<float>(
            (friction[k] - normal * static_cast<double>(contact.normal[k])) * units_.scale());
    }
}

void HullProbe::forget() { state_ = PairState(); }

HullProbeGap HullProbe::widest_gap(const HullProbePose &a, const HullProbePose &b, bool all_edges) {
    const Rigid pose_a = rigid(units_.pose(a.position, a.rotation));
    const Rigid pose_b = rigid(units_.pose(b.position, b.rotation));
    const Relative pose = Rigid::between(pose_b, pose_a).rounded();
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
    const auto margin = static_cast<float>(collision_.settings.speculative_margin);
    const auto best = static_cast<float>(gap);
    EdgeGap edges;
    collision_.kernels->edges(*a_, *b_, pose, faces, best, 1e30F,
                              all_edges ? -1 : std::max(margin, -best), scratch, edges);
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
    const Rigid origin = rigid(btTransform::getIdentity());
    std::vector<Rigid> moved;
    for (const HullProbePose &pose : poses) {
        moved.push_back(rigid(units_.pose(pose.position, pose.rotation)));
    }
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t round = 0; round < rounds; ++round) {
        for (const Rigid &pose : moved) {
            if (!remember) {
                forget();
            }
            find(origin, pose);
        }
    }
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
    return spent.count() / static_cast<double>(rounds * std::max<std::size_t>(1, moved.size()));
}

namespace {

std::unique_ptr<const HullData> hull(double scale, const HullProbeShape &shape) {
    if (shape.radius > 0 && shape.coordinates.empty()) {
        return std::make_unique<const HullData>(shape.radius * scale);
    }
    const auto slice = [](const auto &list) { return rust::Slice(list.data(), list.size()); };
    return make_hull_data(
        Units(scale),
        polyhedron(slice(shape.coordinates), slice(shape.face_starts), slice(shape.face_vertices)),
        shape.radius);
}

} // namespace

std::unique_ptr<HullProbe> new_hull_probe(double scale, const Tolerances &tolerances, bool portable,
                                          const HullProbeShape &a, const HullProbeShape &b) {
    return std::make_unique<HullProbe>(scale, tolerances, portable, hull(scale, a), hull(scale, b));
}

} // namespace pluvia
