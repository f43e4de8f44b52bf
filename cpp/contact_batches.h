// Contacts in batches in which no moving body occurs twice, so that all
// contacts of a batch can be solved at once.
#pragma once

#include "contact_rows.h"

#include <vector>

namespace pluvia {

// Contacts of one batch beside each other, padded with contacts between the
// world and itself, which do nothing.
template <class L> struct alignas(64) Batch {
    int a[Lane<L>::WIDTH], b[Lane<L>::WIDTH];
    int row[Lane<L>::WIDTH]; // -1 where padded
    Three<L> normal, tangent_1, tangent_2;
    Three<L> first_arm_a, first_arm_b; // when the step began
    Three<L> arm_a, arm_b;             // in the sub-step
    L friction, restitution, gap;
    L mass, spring_mass, spring_yield, share, tangent_mass;
    L arrival, struck;               // from sub-step to sub-step
    L target, normal_mass, yield;    // of the sub-step
    L impulse, impulse_1, impulse_2; // of the sub-step
    L total, total_1, total_2;       // of the step
};

// A body in records of eight numbers, which are moved as one.
template <class N> struct alignas(32) PackedBody {
    N motion[8];  // velocity, inverse mass, spin, 0
    N inertia[8]; // inverse, in world axes: xx, yy, zz, xy, xz, yz, 0, 0
    N way[8];     // gone since the step began: shift, -, turn (a rotation vector), -
    N forced[8];  // what external forces add to the motion in a sub-step
};

// Assigns rows to batches, each to the first with room after those that hold
// its bodies already (list scheduling): every body meets its contacts in the
// order of the rows, as if they were solved one by one.
class Schedule {
  public:
    void assign(const std::vector<ContactRow> &rows, const std::vector<SolverBody> &bodies,
                int width);
    int batches() const { return batches_; }
    // Whether a body that moves has rows.
    bool touched(std::size_t body) const { return after_[body] > 0; }
    // Batch and lane of each row.
    const std::vector<int> &batch() const { return batch_; }
    const std::vector<int> &lane() const { return lane_; }

  private:
    int batches_ = 0;
    std::vector<int> batch_, lane_;
    std::vector<int> after_; // by body: the first batch it may occur in
    std::vector<int> used_;  // by batch: lanes taken
    std::vector<int> next_;  // by batch: where to look on when it is full

    int with_room(int from);
};

} // namespace pluvia
