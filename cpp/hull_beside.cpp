#include "hull_beside.h"

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

// Cosine of 2.3 degrees: 5 mm beside the edges, about where a grain ends, a face that
// leans by more is farther than contacts reach at rest, 0.2 mm.
constexpr double FLAT = 0.9992;

// The face beside an edge that looks most along an axis.
struct Flat {
    int face = -1;
    double cosine = FLAT;

    Flat(const HullData &hull, int edge, const double axis[3]) {
        for (const int f : {hull.edge[edge].left, hull.edge[edge].right}) {
            const double normal[3] = {hull.nx[f], hull.ny[f], hull.nz[f]};
            const double along = dot(normal, axis);
            if (along > cosine) {
                face = f;
                cosine = along;
            }
        }
    }
};

} // namespace

PairFace flat_face(const HullData &a, int edge_a, const HullData &b, int edge_b,
                   const double axis[3], const Rigid &b_to_a, const KeptContact &last) {
    const double *r = b_to_a.r;
    double back[3];
    for (int i = 0; i < 3; ++i) {
        back[i] = -(r[i] * axis[0] + r[3 + i] * axis[1] + r[6 + i] * axis[2]);
    }
    const Flat of_a(a, edge_a, axis), of_b(b, edge_b, back);
    bool is_a = of_a.cosine >= of_b.cosine;
    for (int i = 0; i < last.count; ++i) {
        const std::uint32_t id = last.points[i].id;
        if (id >> 28 != FROM_EDGES >> 28) {
            const bool was_a = (id & FROM_FACE_OF_B) == 0;
            is_a = (was_a ? of_a : of_b).face >= 0 ? was_a : is_a;
            break;
        }
    }
    return {is_a, (is_a ? of_a : of_b).face};
}

void keep_beside(const EdgesAt &edges, double near, double slack, std::vector<ClipPoint> &points) {
    const double lean = std::sqrt(std::max(0.0, 1 - edges.cosine * edges.cosine));
    const auto drop = [&](ClipPoint &p) {
        p.gap /= edges.cosine;
        const double *at = edges.at;
        const double d[3] = {p.x[0] - at[0], p.x[1] - at[1], p.x[2] - at[2]};
        return p.gap < edges.gap - slack || std::abs(p.gap) * lean > slack ||
               dot(d, d) <= near * near;
    };
    points.erase(std::remove_if(points.begin(), points.end(), drop), points.end());
    for (ClipPoint &p : points) {
        p.gap = std::max(p.gap, edges.gap);
    }
}

} // namespace pluvia
