#include "hull_landing.h"

#include "hull_memory.h"

#include <algorithm>

namespace pluvia {

namespace {

std::uint32_t corner_id(int vertex) { return static_cast<std::uint32_t>(vertex) & 0x3fffU; }

// A face, in the frame of its hull.
class Plane {
  public:
    Plane(const HullData &hull, int face)
        : hull_(hull), face_(face), normal_{hull.nx[face], hull.ny[face], hull.nz[face]} {}

    double gap(const double x[3]) const {
        return dot(normal_, x) - static_cast<double>(hull_.offset[face_]);
    }

    // Whether a point is inside all sides of the face.
    bool below(const double x[3]) const {
        for (int k = hull_.loop_start[face_]; k < hull_.loop_start[face_ + 1]; ++k) {
            const int e = hull_.loop_edge[k];
            const HullEdge &ends = hull_.edge[e];
            // Loops run counter-clockwise: outside lies to the right.
            const double forward = ends.left == face_ ? 1 : -1;
            const double along[3] = {forward * hull_.ex[e], forward * hull_.ey[e],
                                     forward * hull_.ez[e]};
            const double to[3] = {x[0] - hull_.vx[ends.from], x[1] - hull_.vy[ends.from],
                                  x[2] - hull_.vz[ends.from]};
            const double side[3] = {along[1] * normal_[2] - along[2] * normal_[1],
                                    along[2] * normal_[0] - along[0] * normal_[2],
                                    along[0] * normal_[1] - along[1] * normal_[0]};
            if (dot(side, to) > 0) {
                return false;
            }
        }
        return true;
    }

  private:
    const HullData &hull_;
    int face_;
    double normal_[3];
};

bool is_near(const ClipPoint &point, const double x[3], double slack) {
    const double d[3] = {point.x[0] - x[0], point.x[1] - x[1], point.x[2] - x[2]};
    return dot(d, d) <= slack * slack;
}

} // namespace

int add_landing(const Landing &landing, double margin, double slack, std::vector<ClipPoint> &points,
                int count) {
    const HullData &incident = landing.incident;
    const Plane plane(landing.reference, landing.face);
    for (; count < MOST_POINTS; ++count) {
        ClipPoint next{};
        double lowest = margin;
        for (int v = 0; v < incident.vertices; ++v) {
            const double local[3] = {incident.vx[v], incident.vy[v], incident.vz[v]};
            double now[3], then[3];
            landing.now.apply(local, now);
            landing.then.apply(local, then);
            const double gap = plane.gap(now);
            const double low = std::min(gap, plane.gap(then));
            // What is deep beside the face would be pushed up through it.
            const bool lands =
                low < lowest && (plane.below(now) || (gap >= 0 && plane.below(then)));
            if (lands && std::none_of(points.begin(), points.begin() + count,
                                      [&](const auto &p) { return is_near(p, now, slack); })) {
                lowest = low;
                next = {{now[0], now[1], now[2]}, gap, landing.mark | corner_id(v)};
            }
        }
        if (lowest >= margin) {
            break;
        }
        points.insert(points.begin() + count, next);
    }
    return count;
}

ClipPoint lowest_corner(const HullData &reference, int face, const HullData &incident,
                        const Rigid &pose) {
    const Plane plane(reference, face);
    ClipPoint lowest{{0, 0, 0}, 1e300, 0};
    for (int v = 0; v < incident.vertices; ++v) {
        const double local[3] = {incident.vx[v], incident.vy[v], incident.vz[v]};
        double x[3];
        pose.apply(local, x);
        const double gap = plane.gap(x);
        if (gap < lowest.gap) {
            lowest = {{x[0], x[1], x[2]}, gap, corner_id(v)};
        }
    }
    return lowest;
}

} // namespace pluvia
