// Contacts in batches in which no moving body occurs twice, so that all
// contacts of a batch can be solved at once.
#pragma once

#include "contact_rows.h"

#include <vector>

namespace pluvia {

// Contacts of one batch beside each other, padded with contacts between the
// world and itself, which do nothing: what the sweeps read.
//
// A body turns in these numbers by the root of its inertia times its spin, on
// which an impulse acts by the lever alone: the root of the inverse inertia
// times the moment of a unit impulse along normal or tangent.
template <class L> struct alignas(64) Batch {
    int a[Lane<L>::WIDTH], b[Lane<L>::WIDTH];
    Three<L> normal, tangent_1, tangent_2;
    Three<L> lever_a, lever_b;     // of the normal
    Three<L> lever_1_a, lever_1_b; // of the tangents
    Three<L> lever_2_a, lever_2_b;
    L friction, tangent_mass;
    L target, normal_mass, yield;
    L most;                          // that the normal impulse may become
    L impulse, impulse_1, impulse_2; // of the sub-step
};

// The rest about the contacts of a batch: what a sub-step is set up from.
template <class L> struct alignas(64) BatchMemory {
    int row[Lane<L>::WIDTH]; // -1 where padded
    Three<L> arm_a, arm_b;   // when the step began
    L restitution, gap;
    L gap_now, approach, mass; // when the sub-step began; `mass` along the normal
    // Of a sub-step with impacts: 1 for an impact, the normal impulse without
    // restitution, and all that compression has brought it to.
    L impact, solved, compression, compression_1, compression_2;
    L total, total_1, total_2; // impulses of the step
};

// Of the contacts of a batch: what the last round changed, and the way along which
// rounds go on.
template <class L> struct alignas(64) Search {
    L change{}, change_1{}, change_2{};
    L way{}, way_1{}, way_2{};
};

// All batches of a step; those from `near` on are of contacts that may sleep.
template <class L> struct Contacts {
    UnsetVector<Batch<L>> batches;
    UnsetVector<BatchMemory<L>> memory;
    std::vector<Search<L>> search;
    std::vector<char> awake; // whether the sweeps take the batch in
    std::size_t near = 0;
};

// Bodies in records, each kind by itself: what the sweeps read and write is the
// motion alone. A body that is driven or stands still keeps its motion.
template <class N> struct PackedBodies {
    UnsetVector<Record<N>> motion; // velocity, inverse mass, inertia root times spin, 1 if it turns
    UnsetVector<Record<N>> root; // of the inverse inertia, in the world: xx, yy, zz, xy, xz, yz, -
    UnsetVector<Record<N>> way;  // gone since the step began: shift, -, turn (a rotation vector), -
    UnsetVector<Record<N>> forced; // what external forces add to the motion in a sub-step
    UnsetVector<Record<N>> free;   // motion of the sub-step without contacts
    UnsetVector<Record<N>> before; // motion before the last round
    UnsetVector<Record<N>> search; // the way along which rounds go on, in the motion

    void resize(std::size_t count) {
        for (auto *records : {&motion, &root, &way, &forced}) {
            records->resize(count);
        }
    }
    void begin_search() {
        before = motion;
        search.assign(motion.size(), Record<N>{});
    }
};

// Assigns rows to batches, each to the first with room after those that hold
// its bodies already (list scheduling): every body meets its contacts in the
// order of the rows, as if they were solved one by one; those that may well
// bear something first, in batches of their own.
class Schedule {
  public:
    void assign(const ContactRows &rows, const std::vector<SolverBody> &bodies, int width);
    int batches() const { return batches_; }
    // How many of them, the first, are of near contacts.
    int near_batches() const { return near_batches_; }
    int lanes_used(std::size_t batch) const { return used_[batch]; }
    // Whether a body that moves has rows.
    bool touched(std::size_t body) const { return after_[body] > 0; }
    // Batch and lane of each row.
    const std::vector<int> &batch() const { return batch_; }
    const std::vector<int> &lane() const { return lane_; }

  private:
    int batches_ = 0;
    int near_batches_ = 0;
    int first_ = 0; // batch that a row may be placed in
    std::vector<int> batch_, lane_;
    std::vector<int> after_; // by body: the first batch it may occur in
    std::vector<int> used_;  // by batch: lanes taken
    std::vector<int> next_;  // by batch: where to look on when it is full

    int with_room(int from);
    void place(std::size_t row, const ContactRow &contact, const std::vector<SolverBody> &bodies,
               int width);
};

} // namespace pluvia
