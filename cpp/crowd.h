// The velocity-based AABB margin of bodies within a step.
//
// Two bodies may come closer by the difference of their speeds, and the boxes of a pair must
// overlap before they meet. A margin by the body's own speed does for all others, but where
// thousands fall side by side it makes pairs of all that are within two steps' displacement of each
// other, though none comes any nearer. Here the margin is by the speed against the bodies around.
//
// Law, for any two bodies i and j that come within the speculative margin of
// each other within the step:
//
//   speed_i + speed_j >= |v_i - v_j|
//
// The speed of a body in cell c of a grid is |v - u_c|, with u the mean velocity
// of a cell, and half the largest |u_c - u_c'| to a cell around. For bodies of the
// same or of neighbouring cells the law follows from
// |v_i - v_j| <= |v_i - u_c| + |u_c - u_c'| + |u_c' - v_j|. Bodies of cells further apart do not
// come within the speculative margin, since a cell is larger than two radii, the speculative margin
// and the displacement of both. Wide bodies, such as walls, are in no cell and have a margin by the
// fastest of all besides their own speed.
#pragma once

#include "three.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pluvia {

// What is read of a body; lengths in engine units.
struct CrowdBody {
    double centre[3];
    Vec velocity;
    double radius;
    double turning; // speed at which its farthest point turns
    bool free;
};

class Crowd {
  public:
    // Finds the speeds of all of them, `frame` being the velocity of the place from which distances
    // are counted. False, and nothing is found, where some number is not finite or no body is free.
    bool gather(const std::vector<CrowdBody> &bodies, const Vec &frame, double step, double margin);
    // Of body number `i` of those gathered; its turning comes besides.
    double speed(std::size_t i) const { return speeds_[i]; }

  private:
    struct Cell {
        Vec velocity{0, 0, 0}; // the mean of its bodies
        int bodies = 0;
    };

    std::vector<double> speeds_;
    std::vector<std::int32_t> cell_of_; // WIDE for those in no cell
    std::vector<Cell> cells_;
    std::vector<double> differences_; // by cell, the largest to one around
    double low_[3], edge_;
    int count_[3];

    bool lay_grid(const std::vector<CrowdBody> &bodies, const Vec &frame, double step,
                  double margin);
    void find_means(const std::vector<CrowdBody> &bodies);
    double difference(int x, int y, int z) const;
    std::size_t place(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * count_[1] + y) * count_[0] + x;
    }
};

} // namespace pluvia
