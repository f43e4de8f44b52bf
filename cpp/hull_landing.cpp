#include "hull_landing.h"

#include "hull_memory.h"

#include <algorithm>

namespace pluvia {

namespace {

std::uint32_t corner_id(int vertex) { return static_cast<std::uint32_t>(vertex) & 0x3fffU; }

// Whether a point is inside all sides of a face.
bool below(const HullData &hull, int face, const Vec &x) {
    for (int k = hull.loop_start[face]; k < hull.loop_start[face + 1]; ++k) {
        const int e = hull.loop_edge[k];
        if (hull.beside(face, e).dot(x - hull.vertex(hull.edge[e].from)) > 0) {
            return false;
        }
    }
    return true;
}

bool is_near(const ClipPoint &point, const Vec &x, double slack) {
    const Vec d = point.x - x;
    return d.dot(d) <= slack * slack;
}

} // namespace

int add_landing(const Landing &landing, double margin, double slack, std::vector<ClipPoint> &points,
                int count) {
    const HullData &incident = landing.incident;
    const HullData &reference = landing.reference;
    const int face = landing.face;
    for (; count < MOST_POINTS; ++count) {
        ClipPoint next{};
        double lowest = margin;
        for (int v = 0; v < incident.vertices; ++v) {
            const Vec now = landing.now.apply(incident.vertex(v));
            const Vec then = landing.then.apply(incident.vertex(v));
            const double gap = reference.above(face, now);
            const double low = std::min(gap, reference.above(face, then));
            // What is deep beside the face would be pushed up through it.
            const bool lands = low < lowest && (below(reference, face, now) ||
                                                (gap >= 0 && below(reference, face, then)));
            if (lands && std::none_of(points.begin(), points.begin() + count,
                                      [&](const auto &p) { return is_near(p, now, slack); })) {
                lowest = low;
                next = {now, gap, landing.mark | corner_id(v)};
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
    ClipPoint lowest{{0, 0, 0}, 1e300, 0};
    for (int v = 0; v < incident.vertices; ++v) {
        const Vec x = pose.apply(incident.vertex(v));
        const double gap = reference.above(face, x);
        if (gap < lowest.gap) {
            lowest = {x, gap, corner_id(v)};
        }
    }
    return lowest;
}

} // namespace pluvia
