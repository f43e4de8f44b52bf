// Runs the hull–hull test on one pair outside any world, for tests.
#include "hull_probe.h"

#include "pluvia/src/world/bullet/ffi.rs.h"
#include "shapes.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace pluvia {

HullProbe::HullProbe(double scale, const Tolerances &tolerances, bool portable,
                     std::unique_ptr<const HullData> a, std::unique_ptr<const HullData> b)
    : units_(scale), a_(std::move(a)), b_(std::move(b)) {
    collision_.settings = pair_settings(tolerances, scale);
    collision_.match = tolerances.match_distance * scale;
    collision_.kernels = &axis_kernels(portable);
}

rust::Vec<HullProbePoint> HullProbe::step(const BodyPose &a, const BodyPose &b) {
    const Rigid pose_a = rigid(units_.pose(a));
    const Rigid pose_b = rigid(units_.pose(b));
    // Counts steps in what a point hands on to the one that continues it, and no solver reads here.
    for (Load &load : state_.loads) {
        load.warm_start += 1;
    }
    find(pose_a, pose_b);
    const KeptContact &contact = state_.memory.last;
    const Vec normal = three(contact.normal);
    rust::Vec<HullProbePoint> out;
    for (int i = 0; i < contact.count; ++i) {
        const KeptPoint &p = contact.points[i];
        const Load &load = state_.loads[i];
        const Vec impulse = three(load.impulse);
        const double pressed = -impulse.dot(normal);
        HullProbePoint point{};
        point.gap = units_.metres(static_cast<double>(p.gap));
        point.normal = array(-normal);
        point.on_a = units_.metres(pose_a.apply(three(p.on_a)));
        point.on_b = units_.metres(pose_b.apply(three(p.on_b)));
        point.id = p.id;
        point.age = static_cast<std::int32_t>(load.warm_start) - 1;
        point.impulse = units_.metres(pressed);
        point.friction = units_.metres(impulse + normal * pressed);
        out.push_back(point);
    }
    return out;
}

void HullProbe::find(const Rigid &pose_a, const Rigid &pose_b) {
    PairContact contact;
    collide({*collision_.kernels, *a_, *b_, pose_a, pose_b, PairMotion{}, collision_.settings,
             state_.memory, scratch_, contact, Lightness{1, 1}});
    take_contact(contact, collision_.match, state_);
}

void HullProbe::set_impulse(std::size_t point, double normal,
                            const std::array<double, 3> &friction) {
    const KeptContact &contact = state_.memory.last;
    if (point >= static_cast<std::size_t>(contact.count)) {
        throw std::runtime_error("the pair has no such contact point");
    }
    store((three(friction.data()) - three(contact.normal) * normal) * units_.scale(),
          state_.loads[point].impulse);
}

void HullProbe::forget() { state_ = PairState(); }

HullProbeGap HullProbe::widest_gap(const BodyPose &a, const BodyPose &b, bool all_edges) {
    const Rigid pose_a = rigid(units_.pose(a));
    const Rigid pose_b = rigid(units_.pose(b));
    const Relative pose = Rigid::between(pose_b, pose_a).rounded();
    AxisScratch &scratch = scratch_.axis;
    scratch.fit(*a_, *b_);
    FaceGaps faces;
    collision_.kernels->faces(*a_, *b_, pose, scratch, faces);
    const bool is_a = faces.gap_a >= faces.gap_b;
    double gap = is_a ? faces.gap_a : faces.gap_b;
    Vec axis = is_a ? a_->normal(faces.face_a) : -scratch.normal_b(faces.face_b);
    const auto margin = static_cast<float>(collision_.settings.speculative_margin);
    const auto best = static_cast<float>(gap);
    EdgeGap edges;
    collision_.kernels->edges(*a_, *b_, pose, faces, best, 1e30F,
                              all_edges ? -1 : std::max(margin, -best), scratch, edges);
    if (edges.edge_a >= 0) {
        gap = edges.gap;
        axis = three(edges.axis);
    }
    return {units_.metres(gap), array(pose_a.turn(axis))};
}

std::unique_ptr<HullProbe> new_hull_probe(double scale, const Tolerances &tolerances, bool portable,
                                          const ShapeDefinition &a, const ShapeDefinition &b) {
    const Units units(scale);
    return std::make_unique<HullProbe>(scale, tolerances, portable, make_hull_data(units, a),
                                       make_hull_data(units, b));
}

} // namespace pluvia
