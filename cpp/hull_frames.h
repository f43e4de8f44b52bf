// Two polyhedra, each seen from the other, and what their contact is made of.
#pragma once

#include "hull_landing.h"
#include "hull_pair.h"

#include <algorithm>

namespace pluvia {

class PairFrames {
  protected:
    const AxisKernels &kernels_;
    const HullData &a_, &b_;
    const Rigid &pose_a_, &pose_b_;
    const PairMotion &motion_;
    const PairSettings &settings_;
    PairMemory &memory_;
    PairScratch &scratch_;
    PairContact &out_;
    const double radii_; // of the balls that sweep them
    const Rigid b_to_a_, a_to_b_;
    // Of the smaller body in the frame of the larger: the bound on its motion is tighter.
    const Relative now_;

    explicit PairFrames(const PairCase &c)
        : kernels_(c.kernels), a_(c.a), b_(c.b), pose_a_(c.pose_a), pose_b_(c.pose_b),
          motion_(c.motion), settings_(c.settings), memory_(c.memory), scratch_(c.scratch),
          out_(c.out), radii_(a_.rounding + b_.rounding), b_to_a_(Rigid::between(pose_b_, pose_a_)),
          a_to_b_(b_to_a_.inverse()), now_((b_.radius <= a_.radius ? b_to_a_ : a_to_b_).rounded()) {
    }

    // Where a face of A (`is_a`) or of B is the reference.
    const HullData &reference(bool is_a) const { return is_a ? a_ : b_; }
    const HullData &incident(bool is_a) const { return is_a ? b_ : a_; }
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
        return kernels_.gap_along(a_, b_, axis_a, axis_b, static_cast<float>(axis.dot(b_to_a_.t)));
    }

    // How far any point of one body, or of its core, can have come in the frame of the other since
    // it was at `then`. A gap along an axis changes by no more, so the widest does not either.
    float moved(const Relative &then) const {
        return farthest_way(then, now_, std::min(a_.core_radius(), b_.core_radius()));
    }

    // Whether the points of a face contact can stay where they are on their bodies. Corners that
    // were out of the margin when they were found may land now.
    bool holds_face() const {
        const bool farther =
            settings_.speculative_margin > static_cast<double>(memory_.met_margin) + settings_.hold;
        return memory_.last.count > 0 && !farther &&
               !(static_cast<double>(moved(memory_.met_at)) > settings_.hold);
    }

    // What `holds_face` goes on with.
    void remember_plane(const HullData &reference, int face) {
        memory_.met_at = now_;
        memory_.met_margin = static_cast<float>(settings_.speculative_margin);
        store(reference.normal(face), memory_.plane_normal);
        memory_.plane_offset = reference.offset[face];
    }

    void remember(Feature feature, int first, int second) {
        memory_.feature = feature;
        memory_.first = first;
        memory_.second = second;
    }

    void turn_normal(bool is_a, const Vec &normal) {
        out_.normal = is_a ? pose_a_.turn(normal) : -pose_b_.turn(normal);
    }

    // The incident face of a reference face; `before` is kept while it will do.
    Incident meet(bool is_a, int face, int before) const {
        Incident found =
            incident_face(incident(is_a), to_incident(is_a).turn(reference(is_a).normal(face)),
                          before, settings_.hysteresis);
        if (memory_.recalled && before >= 0) {
            found.face = before;
        }
        return found;
    }

    // Corners of the incident face `other` inside the sides of a reference face, with their gaps
    // between the bodies.
    void clip(bool is_a, int face, int other) {
        clip_face(reference(is_a), face, incident(is_a), other, from_incident(is_a),
                  settings_.speculative_margin + radii_, scratch_.clip);
        for (ClipPoint &point : scratch_.clip.points) {
            point.id |= mark(is_a);
            point.gap -= radii_;
        }
    }

    // Moves those that hold the bodies best to the front, and returns their number.
    int best_points(const Vec &normal) {
        std::uint32_t known[MOST_POINTS];
        const int count = memory_.last.count;
        for (int i = 0; i < count; ++i) {
            known[i] = memory_.last.points[i].id;
        }
        auto &points = scratch_.clip.points;
        return memory_.recalled ? keep_points(points, settings_.hysteresis, known, count)
                                : reduce_points(points, normal, settings_.speculative_margin,
                                                settings_.hysteresis, known, count);
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
