// One pair of hulls outside any world: what the narrow phase finds for given
// poses, step after step. Tests compare it with exact references.
#pragma once

#include "convert.h"
#include "hull_algorithm.h"
#include "rust/cxx.h"

#include <array>
#include <memory>

namespace pluvia {

struct HullProbeGap;
struct HullProbePoint;
struct BodyPose;
struct ShapeDefinition;
struct Tolerances;

class HullProbe {
  public:
    HullProbe(double scale, const Tolerances &tolerances, bool portable,
              std::unique_ptr<const HullData> a, std::unique_ptr<const HullData> b);

    // One step: the contact at these poses, remembering the steps before.
    rust::Vec<HullProbePoint> step(const BodyPose &a, const BodyPose &b);
    // What the solver would leave behind in a point.
    void set_impulse(std::size_t point, double normal, const std::array<double, 3> &friction);
    // Forgets the steps before.
    void forget();
    // The widest gap and its axis, with all pairs of edges or only those that the pruning leaves.
    HullProbeGap widest_gap(const BodyPose &a, const BodyPose &b, bool all_edges);

  private:
    Units units_;
    HullCollision collision_;
    PairScratch scratch_;
    std::unique_ptr<const HullData> a_, b_;
    PairState state_;

    void find(const Rigid &pose_a, const Rigid &pose_b);
};

// `scale`: engine units in a metre. Throws as `make_hull_data`.
std::unique_ptr<HullProbe> new_hull_probe(double scale, const Tolerances &tolerances, bool portable,
                                          const ShapeDefinition &a, const ShapeDefinition &b);

} // namespace pluvia
