// Two hulls, each seen from the other.
#pragma once

#include "hull_axis.h"
#include "hull_clip.h"
#include "hull_memory.h"

namespace pluvia {

class PairFrames {
  protected:
    const AxisKernels &kernels_;
    const HullData &a_;
    const HullData &b_;
    const Rigid b_to_a_;
    const Rigid a_to_b_;

    PairFrames(const AxisKernels &kernels, const HullData &a, const HullData &b,
               const Rigid &pose_a, const Rigid &pose_b)
        : kernels_(kernels), a_(a), b_(b), b_to_a_(Rigid::between(pose_b, pose_a)),
          a_to_b_(b_to_a_.inverse()) {}

    // Of the smaller body in the frame of the larger: the bound on its motion is tighter.
    Relative smaller_pose() const { return (b_.radius <= a_.radius ? b_to_a_ : a_to_b_).rounded(); }

    // Where a face of A (`is_a`) or of B is the reference.
    const HullData &reference(bool is_a) const { return is_a ? a_ : b_; }
    const HullData &incident(bool is_a) const { return is_a ? b_ : a_; }
    const Rigid &from_incident(bool is_a) const { return is_a ? b_to_a_ : a_to_b_; }
    const Rigid &to_incident(bool is_a) const { return is_a ? a_to_b_ : b_to_a_; }
    static std::uint32_t mark(bool is_a) { return is_a ? 0 : FROM_FACE_OF_B; }

    // Gap between the hulls along a unit axis out of A, in A's frame.
    double gap_along(const double axis[3]) const {
        const float axis_a[3] = {static_cast<float>(axis[0]), static_cast<float>(axis[1]),
                                 static_cast<float>(axis[2])};
        const double *r = b_to_a_.r;
        float axis_b[3];
        double shift = 0;
        for (int i = 0; i < 3; ++i) {
            axis_b[i] =
                static_cast<float>(r[i] * axis[0] + r[3 + i] * axis[1] + r[6 + i] * axis[2]);
            shift += axis[i] * b_to_a_.t[i];
        }
        return kernels_.gap_along(a_, b_, axis_a, axis_b, static_cast<float>(shift));
    }

    // A point of the incident hull and what it is above along `normal`, in the frame of
    // the reference hull.
    PairPoint pair_point(bool is_a, const double normal[3], const ClipPoint &from) const {
        PairPoint point;
        point.gap = from.gap;
        point.id = from.id;
        double *on_reference = is_a ? point.on_a : point.on_b;
        double *on_incident = is_a ? point.on_b : point.on_a;
        for (int i = 0; i < 3; ++i) {
            on_reference[i] = from.x[i] - from.gap * normal[i];
        }
        to_incident(is_a).apply(from.x, on_incident);
        return point;
    }
};

} // namespace pluvia
