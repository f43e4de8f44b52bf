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

    Flat(const HullData &hull, int edge, const Vec &axis) {
        for (const int f : {hull.edge[edge].left, hull.edge[edge].right}) {
            const double along = hull.normal(f).dot(axis);
            if (along > cosine) {
                face = f;
                cosine = along;
            }
        }
    }
};

} // namespace

PairFace flat_face(const HullData &a, int edge_a, const HullData &b, int edge_b, const Vec &axis,
                   const Rigid &b_to_a, const KeptContact &last) {
    const Flat of_a(a, edge_a, axis), of_b(b, edge_b, -b_to_a.turn_back(axis));
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
        const Vec d = p.x - edges.at;
        return p.gap < edges.gap - slack || std::abs(p.gap) * lean > slack ||
               d.dot(d) <= near * near;
    };
    points.erase(std::remove_if(points.begin(), points.end(), drop), points.end());
    for (ClipPoint &p : points) {
        p.gap = std::max(p.gap, edges.gap);
    }
}

} // namespace pluvia
