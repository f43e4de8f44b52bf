// Makes contact points from two features that touch: clips a face against a face, intersects two
// edges, and keeps the points that hold the bodies best.
#include "hull_clip.h"

#include "hull_memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pluvia {

namespace {

// Marks a side of the reference face where the index of an edge is expected.
constexpr std::uint32_t SIDE = 1U << 16;

// How much less opposite (as a cosine) last step's incident face may be.
constexpr double OPPOSITE_SLACK = 0.02;

// By how much longer or larger another choice of points must be.
constexpr double CHOICE_SLACK = 1.1;

// Square of the sine between two edges below which they have no common normal.
constexpr double PARALLEL = 1e-8;

// What two lines are called that cross: edge or side `line`, and side `side`.
std::uint32_t crossing(std::uint32_t line, std::uint32_t side) {
    if ((line & SIDE) == 0) {
        return packed(PointOf::Crossing, line, side);
    }
    const std::uint32_t other = line & ~SIDE;
    return packed(PointOf::CornerOfFace, std::min(other, side), std::max(other, side));
}

} // namespace

Rigid Rigid::inverse() const {
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] = r[3 * j + i];
        }
    }
    out.t = -turn_back(t);
    return out;
}

Relative Rigid::rounded() const {
    Relative out;
    std::copy(r, r + 9, out.r);
    store(t, out.t);
    return out;
}

Rigid Rigid::between(const Rigid &from, const Rigid &to) {
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] =
                to.r[i] * from.r[j] + to.r[3 + i] * from.r[3 + j] + to.r[6 + i] * from.r[6 + j];
        }
    }
    out.t = to.turn_back(from.t - to.t);
    return out;
}

Incident incident_face(const HullData &incident, const Vec &normal, int before, double slack) {
    const auto height = [&](int v) { return normal.dot(incident.vertex(v)); };
    const auto facing = [&](int f) { return normal.dot(incident.normal(f)); };
    int lowest = 0;
    double low = height(0);
    for (int v = 1; v < incident.vertices; ++v) {
        const double h = height(v);
        lowest = h < low ? v : lowest;
        low = h < low ? h : low;
    }
    int best = incident.around_face[incident.around_start[lowest]];
    for (int k = incident.around_start[lowest] + 1; k < incident.around_start[lowest + 1]; ++k) {
        const int f = incident.around_face[k];
        best = facing(f) < facing(best) ? f : best;
    }
    if (before >= 0 && before != best && facing(before) <= facing(best) + OPPOSITE_SLACK) {
        for (int k = incident.loop_start[before]; k < incident.loop_start[before + 1]; ++k) {
            if (height(incident.loop_vertex[k]) <= low + slack) {
                return {before, low};
            }
        }
    }
    return {best, low};
}

void clip_face(const HullData &reference, int reference_face, const HullData &incident,
               int incident_face, const Rigid &pose, double margin, ClipScratch &scratch) {
    using Corner = ClipScratch::Corner;
    auto &polygon = scratch.polygon;
    auto &clipped = scratch.clipped;
    polygon.clear();
    scratch.points.clear();
    for (int k = incident.loop_start[incident_face]; k < incident.loop_start[incident_face + 1];
         ++k) {
        Corner corner;
        corner.x = pose.apply(incident.vertex(incident.loop_vertex[k]));
        corner.id = packed(PointOf::Corner, 0, incident.loop_vertex[k]);
        corner.edge = incident.loop_edge[k];
        polygon.push_back(corner);
    }
    const int begin = reference.loop_start[reference_face];
    const int end = reference.loop_start[reference_face + 1];
    for (int k = begin; k < end && !polygon.empty(); ++k) {
        const std::uint32_t e = reference.loop_edge[k];
        const HullEdge &ends = reference.edge[e];
        const Vec side = reference.beside(reference_face, static_cast<int>(e));
        const double offset =
            std::max(side.dot(reference.vertex(ends.from)), side.dot(reference.vertex(ends.to)));
        bool any_outside = false;
        for (Corner &corner : polygon) {
            corner.out = side.dot(corner.x) - offset;
            any_outside = any_outside || corner.out > 0;
        }
        if (!any_outside) {
            continue;
        }
        clipped.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Corner &here = polygon[i];
            const Corner &next = polygon[i + 1 < polygon.size() ? i + 1 : 0];
            const bool inside = here.out <= 0;
            if (inside) {
                clipped.push_back(here);
            }
            if (inside != (next.out <= 0)) {
                const double share = here.out / (here.out - next.out);
                Corner corner;
                corner.x = here.x + (next.x - here.x) * share;
                corner.id = crossing(here.edge, e);
                corner.edge = inside ? (SIDE | e) : here.edge;
                clipped.push_back(corner);
            }
        }
        std::swap(polygon, clipped);
    }
    for (const Corner &corner : polygon) {
        const double gap = reference.above(reference_face, corner.x);
        if (gap <= margin) {
            scratch.points.push_back({corner.x, gap, corner.id});
        }
    }
}

int reduce_points(std::vector<ClipPoint> &points, const Vec &normal, double margin, double slack,
                  const KeptContact &last) {
    const int count = static_cast<int>(points.size());
    // The more a point is in touch, the more it counts.
    const auto weight = [&](const ClipPoint &p) {
        const double far = std::clamp(p.gap / margin, 0.0, 1.0);
        return (1 - 0.5 * far) * (last.has(p.id) ? CHOICE_SLACK : 1);
    };
    const auto area = [&](const ClipPoint &a, const ClipPoint &b, const ClipPoint &c) {
        return (b.x - a.x).cross(c.x - a.x).dot(normal);
    };
    const auto square = [&](const ClipPoint &a, const ClipPoint &b) {
        const Vec ab = b.x - a.x;
        return ab.dot(ab);
    };
    // Moves the point with the highest score to place `chosen`.
    const auto pick = [&](int chosen, double least, auto score) {
        int best = -1;
        double highest = least;
        for (int i = chosen; i < count; ++i) {
            const double s = score(points[i]);
            if (s > highest) {
                highest = s;
                best = i;
            }
        }
        if (best < 0) {
            return false;
        }
        std::swap(points[chosen], points[best]);
        return true;
    };
    if (count == 0) {
        return 0;
    }
    pick(0, -1e300, [&](const ClipPoint &p) { return -p.gap + (last.has(p.id) ? slack : 0); });
    const ClipPoint &first = points[0];
    if (!pick(1, slack * slack, [&](const ClipPoint &p) { return weight(p) * square(first, p); })) {
        return 1;
    }
    const ClipPoint &second = points[1];
    // Narrower than the slack, a third point would only repeat the two.
    const double line = slack * std::sqrt(square(first, second));
    if (!pick(2, line,
              [&](const ClipPoint &p) { return weight(p) * std::abs(area(first, second, p)); })) {
        return 2;
    }
    const ClipPoint &third = points[2];
    const double sense = area(first, second, third) > 0 ? -1 : 1;
    const bool fourth = pick(3, line, [&](const ClipPoint &p) {
        return weight(p) * std::max({sense * area(first, second, p), sense * area(second, third, p),
                                     sense * area(third, first, p)});
    });
    return fourth ? 4 : 3;
}

int keep_points(std::vector<ClipPoint> &points, double slack, const KeptContact &last) {
    const auto rest = std::stable_partition(points.begin(), points.end(),
                                            [&](const ClipPoint &p) { return last.has(p.id); });
    // Ids may repeat.
    int kept = std::min(MOST_POINTS, static_cast<int>(rest - points.begin()));
    const int most = std::max(kept, std::min(4, static_cast<int>(points.size())));
    const auto apart = [&](const ClipPoint &p) {
        double nearest = 1e300;
        for (int i = 0; i < kept; ++i) {
            const Vec d = p.x - points[i].x;
            nearest = std::min(nearest, d.dot(d));
        }
        return nearest;
    };
    while (kept < most) {
        const auto farthest =
            std::max_element(points.begin() + kept, points.end(),
                             [&](const auto &p, const auto &q) { return apart(p) < apart(q); });
        if (apart(*farthest) <= slack * slack) {
            break;
        }
        std::swap(points[kept], *farthest);
        ++kept;
    }
    return kept;
}

void EdgeContact::look_across() {
    on_a = on_a - across * 0.5;
    on_b = on_b + across * 0.5;
    const Vec apart = on_b - on_a;
    gap = std::sqrt(apart.dot(apart));
    axis = apart / gap;
    across = {0, 0, 0};
    off = 0;
}

EdgeContact edge_contact(const HullData &a, int edge_a, const HullData &b, int edge_b,
                         const Rigid &pose) {
    EdgeContact out{};
    const HullEdge &ends_a = a.edge[edge_a];
    const HullEdge &ends_b = b.edge[edge_b];
    const Vec along_a = a.along(edge_a), along_b = pose.turn(b.along(edge_b));
    const Vec n = along_a.cross(along_b);
    const double square = n.dot(n);
    if (square < PARALLEL) {
        return out;
    }
    const bool out_of_b = n.dot(a.normal(ends_a.left)) + n.dot(a.normal(ends_a.right)) < 0;
    const double length = out_of_b ? -std::sqrt(square) : std::sqrt(square);
    const Vec from_a = a.vertex(ends_a.from), from_b = pose.apply(b.vertex(ends_b.from));
    const Vec span_a = a.vertex(ends_a.to) - from_a;
    const Vec span_b = pose.apply(b.vertex(ends_b.to)) - from_b;
    // Where two segments come closest (Ericson, "Real-Time Collision Detection", 2005, section
    // 5.1.9): the points of the lines that face each other, moved to the ends where they lie
    // beyond, one after the other, so that edges that are nearly parallel meet beside each other.
    const Vec apart = from_b - from_a;
    const double length_a = std::max(0.0, span_a.dot(along_a));
    const double length_b = std::max(0.0, span_b.dot(along_b));
    const double cosine = along_a.dot(along_b);
    double at_a = std::clamp(apart.cross(along_b).dot(n) / square, 0.0, length_a);
    const double at_b = std::clamp(at_a * cosine - apart.dot(along_b), 0.0, length_b);
    at_a = std::clamp(at_b * cosine + apart.dot(along_a), 0.0, length_a);
    out.axis = n / length;
    out.on_a = from_a + along_a * at_a;
    out.on_b = from_b + along_b * at_b;
    const Vec left = out.on_b - out.on_a;
    out.gap = out.axis.dot(left);
    // Impulses along the axis at two places would change the angular momentum of both bodies.
    out.across = left - out.axis * out.gap;
    out.off = std::sqrt(out.across.dot(out.across));
    out.on_a = out.on_a + out.across * 0.5;
    out.on_b = out.on_b - out.across * 0.5;
    out.defined = true;
    return out;
}

} // namespace pluvia
