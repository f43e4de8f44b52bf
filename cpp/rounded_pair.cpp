// Finds the contact of two polyhedra of which at least one is rounded: a core swept by a ball.
#include "core_distance.h"
#include "hull_frames.h"

#include <algorithm>
#include <limits>

namespace pluvia {

namespace {

constexpr double ANY = std::numeric_limits<double>::infinity(); // distance

// The point where the bodies are closest, whichever is named first (`swapped_id`).
constexpr std::uint32_t CLOSEST = packed(3, INDEX - 1, INDEX - 1);

// Cosines of the angles between the axis and the normal of a face: up to 0.01 rad the face is what
// touches (the gap along its normal is wrong by half the square of that, of the radii), up to
// 0.02 rad it still is if it was, and up to 0.1 rad it has points beside the closest one.
constexpr double FLAT = 1 - 0.01 * 0.01 / 2;
constexpr double STILL_FLAT = 1 - 0.02 * 0.02 / 2;
constexpr double NEARLY_FLAT = 1 - 0.1 * 0.1 / 2;

// Share of the hysteresis within which gaps in single and in double precision agree.
constexpr double GAP_NOISE = 1.0 / 400;

// Velocity of a point of a body, in the world.
Vec velocity_at(const Rigid &pose, const HullMotion &motion, const Vec &x) {
    return motion.spin.cross(x - pose.t) + motion.velocity;
}

// The pair with its bodies at some poses.
class RoundedPair : PairFrames {
  public:
    explicit RoundedPair(const PairCase &pair) : PairFrames(pair) {}

    // Looks how far the cores are apart. Returns the gap of the bodies, or a lower bound that is
    // above `enough`.
    double look(double enough) {
        cores_ = core_distance(a, b, b_to_a_, enough + radii_);
        if (!cores_.apart) {
            overlap();
        }
        return cores_.distance - radii_;
    }

    // How fast the closest points come nearer to each other.
    double closing() const {
        const Vec axis = pose_a.turn(cores_.axis);
        return velocity_at(pose_a, motion.a, pose_a.apply(cores_.on_a)).dot(axis) -
               velocity_at(pose_b, motion.b, pose_a.apply(cores_.on_b)).dot(axis);
    }

    // The points of the last step, at the gaps they have now. False where there are none to keep.
    bool hold() {
        const bool is_a = memory.feature == Feature::FaceOfA;
        if (memory.feature != face_of(is_a) || memory.recalled || !holds_face()) {
            return false;
        }
        const Vec normal = three(memory.plane_normal);
        turn_normal(is_a, normal);
        out.count = memory.last.count;
        const double top = static_cast<double>(memory.plane_offset) + reference(is_a).rounding;
        for (int i = 0; i < out.count; ++i) {
            const KeptPoint &before = memory.last.points[i];
            PairPoint &point = out.points[i];
            on_incident(is_a, point) = three(is_a ? before.on_b : before.on_a);
            const Vec x = from_incident(is_a).apply(on_incident(is_a, point));
            point.gap = normal.dot(x) - top;
            on_reference(is_a, point) = x - normal * point.gap;
            point.id = before.id;
        }
        out.held = true;
        return true;
    }

    // Makes what `look` found the contact. `end`: from B's frame to A's at the end of the step.
    void take(const Rigid &end) {
        bool is_a = false;
        double cosine = 0;
        const int face = flattest(is_a, cosine);
        const bool flat = cosine >= (was(is_a, face) ? STILL_FLAT : FLAT);
        if (!flat || !cores_.apart || !take_face(is_a, face, end)) {
            memory.let_go();
            take_closest();
            if (cosine >= NEARLY_FLAT && cores_.apart) {
                add_beside(is_a, face, cosine);
            }
        }
        memory.recalled = false;
    }

  private:
    CoreDistance cores_{};

    bool was(bool is_a, int face) const {
        return memory.feature == face_of(is_a) && memory.first == face;
    }

    // The axis on which overlapping cores are least deep, with a point in the overlap.
    void overlap() {
        AxisScratch &axes = scratch.axis;
        axes.fit(a, b);
        FaceGaps faces;
        EdgeGap edges;
        const Relative pose = b_to_a_.rounded();
        kernels.faces(a, b, pose, axes, faces);
        const bool is_a = faces.gap_a >= faces.gap_b;
        kernels.edges(a, b, pose, faces, is_a ? faces.gap_a : faces.gap_b, 1e30F, -1, axes, edges);
        if (edges.edge_a >= 0) {
            const EdgeContact edge = edge_contact(a, edges.edge_a, b, edges.edge_b, b_to_a_);
            // Edges that are nearly parallel may not be what is highest and lowest along their
            // axis.
            const double highest = static_cast<double>(edges.gap) + settings.hysteresis;
            if (edge.defined && edge.gap <= highest) {
                cores_.axis = edge.axis;
                cores_.on_a = edge.on_a;
                cores_.on_b = edge.on_b;
                cores_.distance = edge.gap;
                return;
            }
        }
        const int face = is_a ? faces.face_a : faces.face_b;
        const Vec normal = reference(is_a).normal(face);
        const ClipPoint lowest =
            lowest_corner(reference(is_a), face, incident(is_a), from_incident(is_a));
        const Vec foot = lowest.x - normal * lowest.gap;
        cores_.distance = lowest.gap;
        cores_.axis = is_a ? normal : b_to_a_.turn(-normal);
        cores_.on_a = is_a ? foot : b_to_a_.apply(lowest.x);
        cores_.on_b = is_a ? lowest.x : b_to_a_.apply(foot);
    }

    // The axis out of the reference body, in its frame.
    Vec axis_from(bool is_a) const { return is_a ? cores_.axis : a_to_b_.turn(-cores_.axis); }

    // The face whose normal is nearest to the axis: that of the last step while it is flat enough.
    int flattest(bool &is_a, double &cosine) const {
        int best = -1;
        cosine = -2;
        for (const bool of_a : {true, false}) {
            const Vec axis = axis_from(of_a);
            for (int f = 0; f < reference(of_a).faces; ++f) {
                const double c = reference(of_a).normal(f).dot(axis);
                const bool still = was(of_a, f) && c >= STILL_FLAT;
                if (still || c > cosine) {
                    is_a = of_a;
                    cosine = c;
                    best = f;
                }
                if (still) {
                    return best;
                }
            }
        }
        return best;
    }

    // As `clip` of the incident face, whose number is returned.
    int clip_incident(bool is_a, int face) {
        const int other = meet(is_a, face, was(is_a, face) ? memory.second : -1).face;
        clip(is_a, face, other);
        return other;
    }

    // A point of the incident body's core, `above` the reference body's surface along `normal`, in
    // the reference body's frame.
    PairPoint point_at(bool is_a, const Vec &normal, const ClipPoint &from) const {
        return pair_point(is_a, normal,
                          {from.x - normal * incident(is_a).rounding, from.gap, from.id});
    }

    // False where the face does not hold what is closest.
    bool take_face(bool is_a, int face, const Rigid &end) {
        const HullData &of = reference(is_a);
        const Vec normal = of.normal(face);
        const int other = clip_incident(is_a, face);
        auto &points = scratch.clip.points;
        double deepest = ANY;
        for (const ClipPoint &point : points) {
            deepest = std::min(deepest, point.gap);
        }
        // Where the closest points lie beside the face, they alone give the gap.
        if (points.empty() ||
            deepest > cores_.distance - radii_ + settings.hysteresis * GAP_NOISE) {
            return false;
        }
        int count = best_points(normal);
        if (may_land()) {
            for (ClipPoint &point : points) {
                point.gap += radii_;
            }
            count = add_corners(is_a, face, end, count);
            for (ClipPoint &point : points) {
                point.gap -= radii_;
            }
        }
        turn_normal(is_a, normal);
        out.count = count;
        for (int i = 0; i < count; ++i) {
            out.points[i] = point_at(is_a, normal, points[i]);
        }
        remember(face_of(is_a), face, other);
        remember_plane(of, face);
        return true;
    }

    void take_closest() {
        out.normal = pose_a.turn(cores_.axis);
        out.points[0] = {cores_.on_a + cores_.axis * a.rounding,
                         a_to_b_.apply(cores_.on_b - cores_.axis * b.rounding),
                         cores_.distance - radii_, CLOSEST};
        out.count = 1;
    }

    // Points of a face along which the axis nearly looks, with their gaps along the axis: none is
    // deeper than the closest one.
    void add_beside(bool is_a, int face, double cosine) {
        clip_incident(is_a, face);
        const Vec normal = axis_from(is_a);
        // The closest point of the incident core.
        const Vec at = is_a ? cores_.on_b : a_to_b_.apply(cores_.on_a);
        const double closest = cores_.distance - radii_;
        auto &points = scratch.clip.points;
        for (ClipPoint &point : points) {
            point.gap = std::max(point.gap / cosine, closest);
        }
        // As far from it as the bodies' curvature tells one point from another.
        const double near = std::max(settings.hysteresis, 0.1 * incident(is_a).rounding);
        const auto is_near = [&](const ClipPoint &point) { return point.is_near(at, near); };
        points.erase(std::remove_if(points.begin(), points.end(), is_near), points.end());
        const int count = best_points(normal);
        for (int i = 0; i < count && out.count < MOST_POINTS; ++i) {
            out.points[out.count++] = point_at(is_a, normal, points[i]);
        }
    }
};

// A contact found at poses to come, as the bodies are now. The solver pushes both in one point,
// nearer to the lighter one, and takes its two ends to lie on the normal now: they are put where
// the one point will be right (sphere_pair.cpp).
void bring_back(const PairCase &pair, const Rigid &then_a, const Rigid &then_b) {
    const Lightness &light = pair.lightness;
    const double all = std::max(light.a + light.b, std::numeric_limits<double>::min());
    const Vec &normal = pair.out.normal;
    // Points of the cores go with their bodies, what the balls add stays where it looks.
    const auto arm = [&](const Rigid &then, const Rigid &now, double ball, const Vec &on) {
        return now.turn(then.turn_back(then.turn(on) - normal * ball)) + normal * ball;
    };
    for (int p = 0; p < pair.out.count; ++p) {
        PairPoint &point = pair.out.points[p];
        const Vec arm_a = arm(then_a, pair.pose_a, pair.a.rounding, point.on_a);
        const Vec arm_b = arm(then_b, pair.pose_b, -pair.b.rounding, point.on_b);
        const Vec apart = arm_b + pair.pose_b.t - arm_a - pair.pose_a.t;
        point.gap = apart.dot(normal);
        const Vec across = apart - normal * point.gap;
        point.on_a = pair.pose_a.turn_back(arm_a + across * (light.b / all));
        point.on_b = pair.pose_b.turn_back(arm_b - across * (light.a / all));
    }
}

} // namespace

double collide_rounded(const PairCase &pair) {
    PairMemory &memory = pair.memory;
    PairContact &out = pair.out;
    RoundedPair now(pair);
    if (now.hold()) {
        out.feature = packed(memory.feature, memory.first, memory.second);
        return NOT_APART;
    }
    const double margin = pair.settings.speculative_margin;
    const double gap = now.look(margin);
    if (gap > margin) {
        memory.let_go();
        return gap;
    }
    const HullMotion &motion_a = pair.motion.a, &motion_b = pair.motion.b;
    // The pair at a time of the step to which `what` is done.
    const auto at = [&](double time, const auto &what) {
        const Rigid a = ahead(pair.pose_a, motion_a, time), b = ahead(pair.pose_b, motion_b, time);
        RoundedPair then({pair.kernels, pair.a, pair.b, a, b, pair.motion, pair.settings, memory,
                          pair.scratch, out});
        const double left = then.look(ANY);
        what(then, left, a, b);
    };
    Meeting meeting{pair.motion.step};
    double left = gap, closing = now.closing();
    while (gap > margin - pair.settings.approach && meeting.go_on(left, closing)) {
        at(meeting.time, [&](const RoundedPair &then, double apart, auto &, auto &) {
            left = apart;
            closing = then.closing();
        });
    }
    const Rigid end = b_to_a_ahead(pair);
    if (meeting.time > 0) {
        at(meeting.time, [&](RoundedPair &then, double, const Rigid &a, const Rigid &b) {
            then.take(end);
            bring_back(pair, a, b);
        });
        // Nothing was found at the poses of now that could be held.
        memory.feature = Feature::None;
    } else {
        now.take(end);
    }
    if (out.count > 0 && memory.feature != Feature::None) {
        out.feature = packed(memory.feature, memory.first, memory.second);
    }
    return NOT_APART;
}

} // namespace pluvia
