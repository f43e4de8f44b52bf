// Adds contact points next to those that the test of faces or edges finds: corners about to land,
// and corners of faces that lie almost flat on each other.
#include "hull_beside.h"

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

std::uint32_t corner_id(int vertex) {
    return packed(PointOf::Corner, 0, static_cast<std::uint32_t>(vertex));
}

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

// Gaps above a face, of points of a hull in its own frame; `pose` leads from there to the face's.
struct Above {
    Vec normal;
    double offset;

    Above(const HullData &reference, int face, const Rigid &pose)
        : normal(pose.turn_back(reference.normal(face))), offset(reference.above(face, pose.t)) {}
    double gap(const Vec &x) const { return normal.dot(x) + offset; }
};

// Cosine of 2.3 degrees. About where a grain ends, five eighths of the smallest grains' size
// beside the edges, a face that leans by more is farther off than the contact margin, a fortieth
// of that size (CONTACT_MARGIN, src/scale.rs).
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

int add_landing(const Landing &landing, double margin, double slack, std::vector<ClipPoint> &points,
                int count) {
    const HullData &incident = landing.incident;
    const HullData &reference = landing.reference;
    const int face = landing.face;
    const Above now(reference, face, landing.now), then(reference, face, landing.then);
    for (; count < MOST_POINTS; ++count) {
        ClipPoint next{};
        double lowest = margin;
        for (int v = 0; v < incident.vertices; ++v) {
            const Vec corner = incident.vertex(v);
            const double gap = now.gap(corner);
            const double low = std::min(gap, then.gap(corner));
            if (!(low < lowest)) {
                continue;
            }
            const Vec x = landing.now.apply(corner);
            // What is deep beside the face would be pushed up through it.
            const bool lands = below(reference, face, x) ||
                               (gap >= 0 && below(reference, face, landing.then.apply(corner)));
            if (lands && std::none_of(points.begin(), points.begin() + count,
                                      [&](const auto &p) { return p.is_near(x, slack); })) {
                lowest = low;
                next = {x, reference.above(face, x), landing.mark | corner_id(v)};
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
        return p.gap < edges.gap - slack || std::abs(p.gap) * lean > slack ||
               p.is_near(edges.at, near);
    };
    points.erase(std::remove_if(points.begin(), points.end(), drop), points.end());
    for (ClipPoint &p : points) {
        p.gap = std::max(p.gap, edges.gap);
    }
}

} // namespace pluvia
