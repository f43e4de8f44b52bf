// The contact of a pair with a rounded polyhedron, its bodies at given poses.
#pragma once

#include "core_distance.h"
#include "hull_frames.h"
#include "hull_pair.h"

namespace pluvia {

// The pair with its bodies at some poses.
class RoundedPair : PairFrames {
  public:
    RoundedPair(const AxisKernels &kernels, const HullData &a, const HullData &b,
                const Rigid &pose_a, const Rigid &pose_b, const PairSettings &settings,
                PairMemory &memory, PairScratch &scratch, PairContact &out)
        : PairFrames(kernels, a, b, pose_a, pose_b), pose_a_(pose_a), pose_b_(pose_b),
          settings_(settings), memory_(memory), scratch_(scratch), out_(out),
          radii_(a.rounding + b.rounding) {}

    // Looks how far the cores are apart. Returns the gap of the bodies, or a lower bound that is
    // above `enough`.
    double look(double enough);

    // How fast the closest points come nearer to each other.
    double closing(const PairMotion &motion) const;

    // The points of the last step, at the gaps they have now. False where there are none to keep.
    bool hold();

    // Makes what `look` found the contact. `end`: from B's frame to A's at the end of the step.
    void take(const Rigid &end);

  private:
    const Rigid &pose_a_;
    const Rigid &pose_b_;
    const PairSettings &settings_;
    PairMemory &memory_;
    PairScratch &scratch_;
    PairContact &out_;
    const double radii_;
    CoreDistance cores_{};

    // The axis on which overlapping cores are least deep, with a point in the overlap.
    void overlap();

    // The axis out of the reference body, in its frame.
    void axis_from(bool is_a, double out[3]) const;

    // The face whose normal is nearest to the axis: that of the last step while it is flat enough.
    int flattest(bool &is_a, double &cosine) const;

    void turn_normal(bool is_a, const double normal[3]);

    // Corners of the face that meets a reference face, inside its sides, with their gaps between
    // the bodies. Returns the number of that face.
    int clip(bool is_a, int face);

    int chosen(const double normal[3]);

    // A point of the incident body's core, `above` the reference body's surface along `normal`, in
    // the reference body's frame.
    PairPoint point_at(bool is_a, const double normal[3], const ClipPoint &from) const;

    // False where the face does not hold what is closest.
    bool take_face(bool is_a, int face, const Rigid &end);

    void take_closest();

    // Points of a face along which the axis nearly looks, with their gaps along the axis: none is
    // deeper than the closest one.
    void add_beside(bool is_a, int face, double cosine);

    // The closest point of the incident core, in the reference body's frame.
    void to_reference(bool is_a, double out[3]) const;
};

} // namespace pluvia
