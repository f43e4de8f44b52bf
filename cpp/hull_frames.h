// Two polyhedra, each seen from the other, and what their contact is made of.
#pragma once

#include "hull_beside.h"
#include "hull_pair.h"

#include <algorithm>

namespace pluvia {

class PairFrames : protected PairCase {
  protected:
    const double radii_; // of the balls that sweep them
    const Rigid b_to_a_, a_to_b_;
    // Of the smaller body in the frame of the larger: the bound on its motion is tighter.
    const Relative now_;

    explicit PairFrames(const PairCase &c)
        : PairCase(c), radii_(a.rounding + b.rounding), b_to_a_(Rigid::between(pose_b, pose_a)),
          a_to_b_(b_to_a_.inverse()), now_((b.radius <= a.radius ? b_to_a_ : a_to_b_).rounded()) {}

    // Where a face of A (`is_a`) or of B is the reference.
    const HullData &reference(bool is_a) const { return is_a ? a : b; }
    const HullData &incident(bool is_a) const { return is_a ? b : a; }
    const Rigid &from_incident(bool is_a) const { return is_a ? b_to_a_ : a_to_b_; }
    const Rigid &to_incident(bool is_a) const { return is_a ? a_to_b_ : b_to_a_; }
    static Vec &on_reference(bool is_a, PairPoint &point) { return is_a ? point.on_a : point.on_b; }
    static Vec &on_incident(bool is_a, PairPoint &point) { return is_a ? point.on_b : point.on_a; }
    static std::uint32_t mark(bool is_a) { return is_a ? 0 : FROM_FACE_OF_B; }
    static Feature face_of(bool is_a) { return is_a ? Feature::FaceOfA : Feature::FaceOfB; }

    // Gap between the hulls along a unit axis out of A, in A's frame.
    double gap_along(const Vec &axis) const {
        float axis_a[3], axis_b[3];
        store(axis, axis_a);
        store(b_to_a_.turn_back(axis), axis_b);
        return kernels.gap_along(a, b, axis_a, axis_b, static_cast<float>(axis.dot(b_to_a_.t)));
    }

    // How far any point of one body, or of its core, can have come in the frame of the other since
    // it was at `then`. A gap along an axis changes by no more, so the widest does not either.
    // With `more`, of a point so far beyond it that turns along.
    float moved(const Relative &then, float more = 0) const {
        const HullData &smaller = b.radius <= a.radius ? b : a;
        return farthest_displacement(then, now_, smaller.core_radius() + more);
    }

    // The ball of a point that is kept on its body would turn with it: it walked in front of a body
    // that rolls, and drove it.
    float ball() const { return static_cast<float>(std::max(a.rounding, b.rounding)); }

    // Whether the points of a face contact can stay where they are on their bodies. Corners that
    // were out of the margin when they were found may land now.
    bool holds_face() const {
        const bool farther = settings.speculative_margin > memory.met_margin + settings.hold;
        return memory.last.count > 0 && !farther && !(moved(memory.met_at, ball()) > settings.hold);
    }

    // What `holds_face` goes on with.
    void remember_plane(const HullData &reference, int face) {
        memory.met_at = now_;
        memory.met_margin = static_cast<float>(settings.speculative_margin);
        store(reference.normal(face), memory.plane_normal);
        memory.plane_offset = reference.offset[face];
    }

    void remember(Feature feature, int first, int second) {
        memory.feature = feature;
        memory.first = first;
        memory.second = second;
    }

    void turn_normal(bool is_a, const Vec &normal) {
        out.normal = is_a ? pose_a.turn(normal) : -pose_b.turn(normal);
    }

    // The incident face of a reference face; `before` is kept while it will do.
    Incident meet(bool is_a, int face, int before) const {
        Incident found =
            incident_face(incident(is_a), to_incident(is_a).turn(reference(is_a).normal(face)),
                          before, settings.hysteresis);
        if (memory.recalled && before >= 0) {
            found.face = before;
        }
        return found;
    }

    // Corners of the incident face `other` inside the sides of a reference face, with their gaps
    // between the bodies.
    void clip(bool is_a, int face, int other) {
        clip_face(reference(is_a), face, incident(is_a), other, from_incident(is_a),
                  settings.speculative_margin + radii_, scratch.clip);
        for (ClipPoint &point : scratch.clip.points) {
            point.id |= mark(is_a);
            point.gap -= radii_;
        }
    }

    // Moves those that hold the bodies best to the front, and returns their number.
    int best_points(const Vec &normal) {
        auto &points = scratch.clip.points;
        return memory.recalled ? keep_points(points, settings.hysteresis, memory.last)
                               : reduce_points(points, normal, settings.speculative_margin,
                                               settings.hysteresis, memory.last);
    }

    // Whether bodies come so fast that corners beside those clipped may land within the step.
    bool may_land() const { return settings.approach > settings.speculative_margin / 2; }

    // Adds corners to the first `count` points, whose gaps are those of the cores, and returns how
    // many there are now: those that land, or that may touch before points are found again, since
    // they may be held. `end`: from B's frame to A's at the end of the step, if bodies may land.
    int add_corners(bool is_a, int face, const Rigid &end, int count) {
        const bool lands = may_land();
        const Rigid &now = from_incident(is_a);
        const double close = settings.hold + settings.approach;
        return add_landing({reference(is_a), face, incident(is_a), now,
                            !lands ? now
                            : is_a ? end
                                   : end.inverse(),
                            mark(is_a)},
                           (lands ? settings.speculative_margin : close) + radii_,
                           settings.hysteresis, scratch.clip.points, count);
    }

    // A point of the incident hull and what it is above along `normal`, in the frame of
    // the reference hull.
    PairPoint pair_point(bool is_a, const Vec &normal, const ClipPoint &from) const {
        PairPoint point;
        on_reference(is_a, point) = from.x - normal * from.gap;
        on_incident(is_a, point) = to_incident(is_a).apply(from.x);
        point.gap = from.gap;
        point.id = from.id;
        return point;
    }
};

} // namespace pluvia
