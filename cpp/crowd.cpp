// Computes how fast each body moves relative to the bodies around it, on a grid of cells, so that
// grains falling side by side need no wide AABB margins.
#include "crowd.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pluvia {

namespace {

constexpr std::int32_t WIDE = -1;

// Free bodies of more mean radii than this are wide: one of them would make
// all cells as large as itself.
constexpr double WIDE_RADII = 3;

// Most cells of a grid per body; where bodies are far apart, its cells are larger.
constexpr double CELLS_PER_BODY = 4;

bool finite(const CrowdBody &body) {
    const Vec sum = three(body.centre) + body.velocity;
    return std::isfinite(body.radius + body.turning + sum.x + sum.y + sum.z);
}

} // namespace

bool Crowd::lay_grid(const std::vector<CrowdBody> &bodies, const Vec &frame, double step,
                     double margin) {
    double radii = 0;
    int free = 0;
    for (const CrowdBody &body : bodies) {
        if (!finite(body)) {
            return false;
        }
        radii += body.free ? body.radius : 0;
        free += body.free ? 1 : 0;
    }
    const double widest = free > 0 ? WIDE_RADII * radii / free : 0;
    double radius = 0, turning = 0, speed = 0;
    double high[3];
    std::fill(low_, low_ + 3, std::numeric_limits<double>::infinity());
    std::fill(high, high + 3, -std::numeric_limits<double>::infinity());
    for (std::size_t n = 0; n < bodies.size(); ++n) {
        const CrowdBody &body = bodies[n];
        cell_of_[n] = body.free && body.radius <= widest ? 0 : WIDE;
        if (cell_of_[n] == WIDE) {
            continue;
        }
        radius = std::max(radius, body.radius);
        turning = std::max(turning, body.turning);
        speed = std::max(speed, length(body.velocity - frame));
        for (int i = 0; i < 3; ++i) {
            low_[i] = std::min(low_[i], body.centre[i]);
            high[i] = std::max(high[i], body.centre[i]);
        }
    }
    edge_ = 2 * radius + margin + 2 * step * (speed + turning);
    // Also where no body is free, which leaves the ends infinite.
    const double ends = (high[0] - low_[0]) + (high[1] - low_[1]) + (high[2] - low_[2]);
    if (!(edge_ > 0) || !std::isfinite(edge_) || !std::isfinite(ends)) {
        return false;
    }
    const double most = CELLS_PER_BODY * static_cast<double>(bodies.size());
    for (;; edge_ *= 2) {
        double cells = 1;
        for (int i = 0; i < 3; ++i) {
            const double along = std::floor((high[i] - low_[i]) / edge_) + 1;
            // Bodies beyond the last cell count as in it (more than 250 000 bodies in a line alone
            // come so far): they get wider margins, and the law holds.
            count_[i] = static_cast<int>(std::min(along, 1e6));
            cells *= along;
        }
        if (cells <= most) {
            return true;
        }
    }
}

void Crowd::find_means(const std::vector<CrowdBody> &bodies) {
    cells_.assign(place(0, 0, count_[2]), Cell{});
    for (std::size_t n = 0; n < bodies.size(); ++n) {
        if (cell_of_[n] == WIDE) {
            continue;
        }
        const CrowdBody &body = bodies[n];
        int at[3];
        for (int i = 0; i < 3; ++i) {
            at[i] = std::min(static_cast<int>((body.centre[i] - low_[i]) / edge_), count_[i] - 1);
        }
        cell_of_[n] = static_cast<std::int32_t>(place(at[0], at[1], at[2]));
        Cell &cell = cells_[cell_of_[n]];
        cell.bodies += 1;
        cell.velocity = cell.velocity + body.velocity;
    }
    for (Cell &cell : cells_) {
        cell.velocity = cell.velocity / std::max(cell.bodies, 1);
    }
}

double Crowd::difference(int x, int y, int z) const {
    const Cell &own = cells_[place(x, y, z)];
    double most = 0;
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, count_[2] - 1); ++k) {
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, count_[1] - 1); ++j) {
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, count_[0] - 1); ++i) {
                const Cell &other = cells_[place(i, j, k)];
                if (other.bodies > 0) {
                    most = std::max(most, length(own.velocity - other.velocity));
                }
            }
        }
    }
    return most;
}

bool Crowd::gather(const std::vector<CrowdBody> &bodies, const Vec &frame, double step,
                   double margin) {
    cell_of_.resize(bodies.size());
    speeds_.resize(bodies.size());
    if (!lay_grid(bodies, frame, step, margin)) {
        return false;
    }
    find_means(bodies);
    differences_.resize(cells_.size());
    for (int z = 0; z < count_[2]; ++z) {
        for (int y = 0; y < count_[1]; ++y) {
            for (int x = 0; x < count_[0]; ++x) {
                const std::size_t at = place(x, y, z);
                differences_[at] = cells_[at].bodies > 0 ? difference(x, y, z) : 0;
            }
        }
    }
    double fastest = 0;
    for (const CrowdBody &body : bodies) {
        fastest = std::max(fastest, length(body.velocity - frame));
    }
    for (std::size_t n = 0; n < bodies.size(); ++n) {
        const Vec &velocity = bodies[n].velocity;
        if (cell_of_[n] == WIDE) {
            speeds_[n] = length(velocity - frame) + fastest;
            continue;
        }
        const auto at = static_cast<std::size_t>(cell_of_[n]);
        speeds_[n] = length(velocity - cells_[at].velocity) + differences_[at] / 2;
    }
    return true;
}

} // namespace pluvia
