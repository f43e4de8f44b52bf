// Parts of a world outside any world, for tests: what the narrow phase finds for a pair at given
// poses, step after step; threads, that they share work without losing any of it, and that what
// fails in one of them comes back; velocity-based AABB margins; and what the process holds of its
// allocator, for tests that look for leaks.
#pragma once

#include "convert.h"
#include "hull_algorithm.h"
#include "rust/cxx.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace pluvia {

struct CrowdProbeBody;
struct HullProbeGap;
struct HullProbePoint;
struct BodyPose;
struct ShapeDefinition;
struct Tolerances;

class HullProbe {
  public:
    // `scale`: engine units in a metre. Throws as `make_hull_data`.
    HullProbe(double scale, const Tolerances &tolerances, bool portable, const ShapeDefinition &a,
              const ShapeDefinition &b);

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
};

std::unique_ptr<HullProbe> new_hull_probe(double scale, const Tolerances &tolerances, bool portable,
                                          const ShapeDefinition &a, const ShapeDefinition &b);

// Adds up the numbers below `size`, `rounds` times, each number by whichever of `threads` threads
// comes to it. Throws std::runtime_error when one comes to the number `fails_at`.
std::uint64_t shared_sum(std::int32_t threads, std::size_t size, std::size_t rounds,
                         std::size_t fails_at);

// What `threads` threads make, `rounds` times, of shares that follow each other without all being
// over, and what one makes of the same: each thread has a number of its own and shares one with
// each neighbour, in turn from share to share, and what comes out depends on the order.
std::array<std::uint64_t, 2> chained_work(std::int32_t threads, std::size_t rounds);

// How long one job of these shares takes of what threads can share, and would take on
// 2, 8 and 16 of them, in s. `leasts`: of each share, as in `Share`.
std::array<double, 4> shared_time(std::int32_t threads, rust::Slice<const std::size_t> sizes,
                                  rust::Slice<const std::size_t> leasts);

// The speed of each body, as of Crowd; lengths in any one unit. Empty where Crowd finds none.
rust::Vec<double> crowd_speeds(rust::Slice<const CrowdProbeBody> bodies,
                               const std::array<double, 3> &frame, double step, double margin);

// Bytes handed out and not given back, in all arenas and in blocks that the allocator mapped one by
// one; C++ and Rust share the allocator. -1 where it does not say.
std::int64_t bytes_handed_out();

} // namespace pluvia
