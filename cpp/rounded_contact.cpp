#include "rounded_contact.h"

#include "hull_landing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pluvia {

namespace {

// The point where the bodies are closest, whichever is named first (`swapped_id`).
constexpr std::uint32_t CLOSEST = FROM_EDGES | 0x3ffeU << 14 | 0x3ffeU;

// Cosines of the angles between the axis and the normal of a face: up to 0.01 rad the face is what
// touches (the gap along its normal is wrong by half the square of that, of the radii), up to
// 0.02 rad it still is if it was, and up to 0.1 rad it has points beside the closest one.
constexpr double FLAT = 1 - 0.01 * 0.01 / 2;
constexpr double STILL_FLAT = 1 - 0.02 * 0.02 / 2;
constexpr double NEARLY_FLAT = 1 - 0.1 * 0.1 / 2;

// Share of the hysteresis within which gaps in single and in double precision agree.
constexpr double GAP_NOISE = 1.0 / 400;

void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

// Velocity of a point of a body, in the world.
void velocity_at(const Rigid &pose, const HullMotion &motion, const double x[3], double out[3]) {
    double arm[3];
    for (int i = 0; i < 3; ++i) {
        arm[i] = x[i] - pose.t[i];
    }
    cross(motion.spin, arm, out);
    for (int i = 0; i < 3; ++i) {
        out[i] += motion.velocity[i];
    }
}

} // namespace

double RoundedPair::look(double enough) {
    cores_ = core_distance(a_, b_, b_to_a_, enough + radii_);
    if (!cores_.apart) {
        overlap();
    }
    return cores_.distance - radii_;
}

double RoundedPair::closing(const PairMotion &motion) const {
    double a[3], b[3], of_a[3], of_b[3], axis[3];
    pose_a_.apply(cores_.on_a, a);
    pose_a_.apply(cores_.on_b, b);
    pose_a_.turn(cores_.axis, axis);
    velocity_at(pose_a_, motion.a, a, of_a);
    velocity_at(pose_b_, motion.b, b, of_b);
    return dot(of_a, axis) - dot(of_b, axis);
}

bool RoundedPair::hold() {
    const Feature feature = memory_.feature;
    const bool of_face = feature == Feature::FaceOfA || feature == Feature::FaceOfB;
    const bool farther =
        settings_.speculative_margin > static_cast<double>(memory_.met_margin) + settings_.hold;
    const float core = std::min(a_.core_radius(), b_.core_radius());
    if (!of_face || memory_.recalled || memory_.last.count == 0 || farther ||
        static_cast<double>(farthest_way(memory_.met_at, smaller_pose(), core)) > settings_.hold) {
        return false;
    }
    const bool is_a = feature == Feature::FaceOfA;
    const double normal[3] = {memory_.plane_normal[0], memory_.plane_normal[1],
                              memory_.plane_normal[2]};
    turn_normal(is_a, normal);
    out_.count = memory_.last.count;
    const double top = static_cast<double>(memory_.plane_offset) + reference(is_a).rounding;
    for (int i = 0; i < out_.count; ++i) {
        const KeptPoint &before = memory_.last.points[i];
        PairPoint &point = out_.points[i];
        double x[3], on_reference[3], on_incident[3];
        for (int k = 0; k < 3; ++k) {
            on_incident[k] = static_cast<double>((is_a ? before.on_b : before.on_a)[k]);
        }
        from_incident(is_a).apply(on_incident, x);
        point.gap = dot(normal, x) - top;
        for (int k = 0; k < 3; ++k) {
            on_reference[k] = x[k] - point.gap * normal[k];
        }
        std::copy(on_incident, on_incident + 3, is_a ? point.on_b : point.on_a);
        std::copy(on_reference, on_reference + 3, is_a ? point.on_a : point.on_b);
        point.id = before.id;
    }
    out_.held = true;
    return true;
}

void RoundedPair::take(const Rigid &end) {
    out_.count = 0;
    bool is_a = false;
    double cosine = 0;
    const int face = flattest(is_a, cosine);
    const bool was =
        memory_.feature == (is_a ? Feature::FaceOfA : Feature::FaceOfB) && memory_.first == face;
    const bool flat = cosine >= (was ? STILL_FLAT : FLAT);
    if (flat && cores_.apart && take_face(is_a, face, end)) {
        memory_.recalled = false;
        return;
    }
    memory_.feature = Feature::None;
    memory_.has_axis = false;
    memory_.recalled = false;
    take_closest();
    if (cosine >= NEARLY_FLAT && cores_.apart) {
        add_beside(is_a, face, cosine);
    }
}

void RoundedPair::overlap() {
    const Relative pose = b_to_a_.rounded();
    AxisScratch &axes = scratch_.axis;
    axes.fit(a_, b_);
    FaceGaps faces;
    EdgeGap edges;
    kernels_.faces(a_, b_, pose, axes, faces);
    const bool is_a = faces.gap_a >= faces.gap_b;
    const float widest = is_a ? faces.gap_a : faces.gap_b;
    kernels_.edges(a_, b_, pose, faces, widest, 1e30F, -1, axes, edges);
    if (edges.edge_a >= 0) {
        const EdgeContact edge = edge_contact(a_, edges.edge_a, b_, edges.edge_b, b_to_a_);
        if (edge.defined) {
            std::copy(edge.axis, edge.axis + 3, cores_.axis);
            std::copy(edge.on_a, edge.on_a + 3, cores_.on_a);
            std::copy(edge.on_b, edge.on_b + 3, cores_.on_b);
            cores_.distance = edge.gap;
            return;
        }
    }
    const int face = is_a ? faces.face_a : faces.face_b;
    const HullData &of = reference(is_a);
    const double normal[3] = {of.nx[face], of.ny[face], of.nz[face]};
    const ClipPoint lowest = lowest_corner(of, face, incident(is_a), from_incident(is_a));
    double foot[3];
    for (int i = 0; i < 3; ++i) {
        foot[i] = lowest.x[i] - lowest.gap * normal[i];
    }
    cores_.distance = lowest.gap;
    if (is_a) {
        std::copy(normal, normal + 3, cores_.axis);
        std::copy(foot, foot + 3, cores_.on_a);
        std::copy(lowest.x, lowest.x + 3, cores_.on_b);
    } else {
        const double out[3] = {-normal[0], -normal[1], -normal[2]};
        b_to_a_.turn(out, cores_.axis);
        b_to_a_.apply(lowest.x, cores_.on_a);
        b_to_a_.apply(foot, cores_.on_b);
    }
}

void RoundedPair::axis_from(bool is_a, double out[3]) const {
    if (is_a) {
        std::copy(cores_.axis, cores_.axis + 3, out);
        return;
    }
    const double back[3] = {-cores_.axis[0], -cores_.axis[1], -cores_.axis[2]};
    a_to_b_.turn(back, out);
}

int RoundedPair::flattest(bool &is_a, double &cosine) const {
    int best = -1;
    cosine = -2;
    for (const bool of_a : {true, false}) {
        const HullData &hull = reference(of_a);
        double axis[3];
        axis_from(of_a, axis);
        const bool was = memory_.feature == (of_a ? Feature::FaceOfA : Feature::FaceOfB);
        for (int f = 0; f < hull.faces; ++f) {
            const double n[3] = {hull.nx[f], hull.ny[f], hull.nz[f]};
            const double c = dot(n, axis);
            if (was && f == memory_.first && c >= STILL_FLAT) {
                is_a = of_a;
                cosine = c;
                return f;
            }
            if (c > cosine) {
                is_a = of_a;
                cosine = c;
                best = f;
            }
        }
    }
    return best;
}

void RoundedPair::turn_normal(bool is_a, const double normal[3]) {
    double turned[3];
    (is_a ? pose_a_ : pose_b_).turn(normal, turned);
    for (int i = 0; i < 3; ++i) {
        out_.normal[i] = is_a ? turned[i] : -turned[i];
    }
}

int RoundedPair::clip(bool is_a, int face) {
    const HullData &of = reference(is_a);
    const double normal[3] = {of.nx[face], of.ny[face], of.nz[face]};
    double seen[3];
    to_incident(is_a).turn(normal, seen);
    const bool was =
        memory_.feature == (is_a ? Feature::FaceOfA : Feature::FaceOfB) && memory_.first == face;
    const int before = was ? memory_.second : -1;
    const Incident found = incident_face(incident(is_a), seen, before, settings_.hysteresis);
    const int other = memory_.recalled && before >= 0 ? before : found.face;
    clip_face(of, face, incident(is_a), other, from_incident(is_a),
              settings_.speculative_margin + radii_, scratch_.clip);
    for (ClipPoint &point : scratch_.clip.points) {
        point.id |= mark(is_a);
        point.gap -= radii_;
    }
    return other;
}

int RoundedPair::chosen(const double normal[3]) {
    auto &points = scratch_.clip.points;
    std::uint32_t known[MOST_POINTS];
    const int count = memory_.last.count;
    for (int i = 0; i < count; ++i) {
        known[i] = memory_.last.points[i].id;
    }
    return memory_.recalled ? keep_points(points, settings_.hysteresis, known, count)
                            : reduce_points(points, normal, settings_.speculative_margin,
                                            settings_.hysteresis, known, count);
}

PairPoint RoundedPair::point_at(bool is_a, const double normal[3], const ClipPoint &from) const {
    PairPoint point{};
    double on_incident[3];
    double *on_reference = is_a ? point.on_a : point.on_b;
    for (int i = 0; i < 3; ++i) {
        on_incident[i] = from.x[i] - incident(is_a).rounding * normal[i];
        on_reference[i] = on_incident[i] - from.gap * normal[i];
    }
    to_incident(is_a).apply(on_incident, is_a ? point.on_b : point.on_a);
    point.gap = from.gap;
    point.id = from.id;
    return point;
}

bool RoundedPair::take_face(bool is_a, int face, const Rigid &end) {
    const HullData &of = reference(is_a);
    const double normal[3] = {of.nx[face], of.ny[face], of.nz[face]};
    const int other = clip(is_a, face);
    auto &points = scratch_.clip.points;
    double deepest = std::numeric_limits<double>::infinity();
    for (const ClipPoint &point : points) {
        deepest = std::min(deepest, point.gap);
    }
    // Where the closest points lie beside the face, they alone give the gap.
    if (points.empty() || deepest > cores_.distance - radii_ + settings_.hysteresis * GAP_NOISE) {
        return false;
    }
    int count = chosen(normal);
    if (settings_.approach > settings_.speculative_margin / 2) {
        for (ClipPoint &point : points) {
            point.gap += radii_;
        }
        count = add_landing(
            {of, face, incident(is_a), from_incident(is_a), is_a ? end : end.inverse(), mark(is_a)},
            settings_.speculative_margin + radii_, settings_.hysteresis, points, count);
        for (ClipPoint &point : points) {
            point.gap -= radii_;
        }
    }
    turn_normal(is_a, normal);
    out_.count = count;
    for (int i = 0; i < count; ++i) {
        out_.points[i] = point_at(is_a, normal, points[static_cast<std::size_t>(i)]);
    }
    memory_.feature = is_a ? Feature::FaceOfA : Feature::FaceOfB;
    memory_.first = face;
    memory_.second = other;
    memory_.met_at = smaller_pose();
    memory_.met_margin = static_cast<float>(settings_.speculative_margin);
    memory_.plane_normal[0] = of.nx[face];
    memory_.plane_normal[1] = of.ny[face];
    memory_.plane_normal[2] = of.nz[face];
    memory_.plane_offset = of.offset[face];
    return true;
}

void RoundedPair::take_closest() {
    pose_a_.turn(cores_.axis, out_.normal);
    PairPoint &point = out_.points[0];
    double on_b[3];
    for (int i = 0; i < 3; ++i) {
        point.on_a[i] = cores_.on_a[i] + a_.rounding * cores_.axis[i];
        on_b[i] = cores_.on_b[i] - b_.rounding * cores_.axis[i];
    }
    a_to_b_.apply(on_b, point.on_b);
    point.gap = cores_.distance - radii_;
    point.id = CLOSEST;
    out_.count = 1;
}

void RoundedPair::add_beside(bool is_a, int face, double cosine) {
    clip(is_a, face);
    double normal[3], at[3];
    axis_from(is_a, normal);
    to_reference(is_a, at);
    const double closest = cores_.distance - radii_;
    auto &points = scratch_.clip.points;
    for (ClipPoint &point : points) {
        point.gap = std::max(point.gap / cosine, closest);
    }
    // As far from it as the bodies' curvature tells one point from another.
    const double near = std::max(settings_.hysteresis, 0.1 * incident(is_a).rounding);
    points.erase(
        std::remove_if(
            points.begin(), points.end(),
            [&](const ClipPoint &point) {
                const double d[3] = {point.x[0] - at[0], point.x[1] - at[1], point.x[2] - at[2]};
                return dot(d, d) <= near * near;
            }),
        points.end());
    const int count = chosen(normal);
    for (int i = 0; i < count && out_.count < MOST_POINTS; ++i) {
        out_.points[out_.count++] = point_at(is_a, normal, points[static_cast<std::size_t>(i)]);
    }
}

void RoundedPair::to_reference(bool is_a, double out[3]) const {
    if (is_a) {
        std::copy(cores_.on_b, cores_.on_b + 3, out);
    } else {
        a_to_b_.apply(cores_.on_a, out);
    }
}

} // namespace pluvia
