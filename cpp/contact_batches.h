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
    Three<L> normal, tangent_1, tangent_2, arm_a, arm_b;
    L friction, normal_mass, yield, target;
    L tangent_mass;
    L impulse, impulse_1, impulse_2;
};

// Body state beside each other in memory.
template <class N> struct PackedBody {
    N velocity[3];
    N spin[3];
    N inverse_mass;
    N inertia[6]; // xx, yy, zz, xy, xz, yz
    N padding[3];
};

// Assigns rows to batches, each to the first with room after those that hold
// its bodies already (list scheduling): every body meets its contacts in the
// order of the rows, as if they were solved one by one.
class Schedule {
  public:
    void assign(const std::vector<ContactRow> &rows, const std::vector<SolverBody> &bodies,
                int width);
    int batches() const { return batches_; }
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
