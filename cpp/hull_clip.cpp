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

void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void minus(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; ++i) {
        out[i] = a[i] - b[i];
    }
}

void vertex(const HullData &hull, int v, double out[3]) {
    out[0] = hull.vx[v], out[1] = hull.vy[v], out[2] = hull.vz[v];
}

void face_normal(const HullData &hull, int f, double out[3]) {
    out[0] = hull.nx[f], out[1] = hull.ny[f], out[2] = hull.nz[f];
}

std::uint32_t name(std::uint32_t kind, std::uint32_t first, std::uint32_t second) {
    // Room for 2^14 edges each; beyond, names repeat and points are reported
    // apart by their distance alone.
    return kind << 28 | (first & 0x3fffU) << 14 | (second & 0x3fffU);
}

// What two lines are called that cross: edge or side `line`, and side `side`.
std::uint32_t crossing(std::uint32_t line, std::uint32_t side) {
    if ((line & SIDE) == 0) {
        return name(1, line, side);
    }
    const std::uint32_t other = line & ~SIDE;
    return name(2, std::min(other, side), std::max(other, side));
}

} // namespace

Rigid Rigid::inverse() const {
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] = r[3 * j + i];
        }
        out.t[i] = -(r[i] * t[0] + r[3 + i] * t[1] + r[6 + i] * t[2]);
    }
    return out;
}

Relative Rigid::rounded() const {
    Relative out;
    std::copy(r, r + 9, out.r);
    std::copy(t, t + 3, out.t);
    return out;
}

Rigid Rigid::between(const Rigid &from, const Rigid &to) {
    Rigid out;
    const double d[3] = {from.t[0] - to.t[0], from.t[1] - to.t[1], from.t[2] - to.t[2]};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] =
                to.r[i] * from.r[j] + to.r[3 + i] * from.r[3 + j] + to.r[6 + i] * from.r[6 + j];
        }
        out.t[i] = to.r[i] * d[0] + to.r[3 + i] * d[1] + to.r[6 + i] * d[2];
    }
    return out;
}

Incident incident_face(const HullData &incident, const double normal[3], int before, double slack) {
    const auto height = [&](int v) {
        return normal[0] * incident.vx[v] + normal[1] * incident.vy[v] + normal[2] * incident.vz[v];
    };
    const auto facing = [&](int f) {
        return normal[0] * incident.nx[f] + normal[1] * incident.ny[f] + normal[2] * incident.nz[f];
    };
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
        double local[3];
        vertex(incident, incident.loop_vertex[k], local);
        Corner corner;
        pose.apply(local, corner.x);
        corner.id = name(0, 0, incident.loop_vertex[k]);
        corner.edge = incident.loop_edge[k];
        polygon.push_back(corner);
    }
    double normal[3];
    face_normal(reference, reference_face, normal);
    const int begin = reference.loop_start[reference_face];
    const int end = reference.loop_start[reference_face + 1];
    for (int k = begin; k < end && !polygon.empty(); ++k) {
        const std::uint32_t e = reference.loop_edge[k];
        const HullEdge &ends = reference.edge[e];
        const double forward = ends.left == reference_face ? 1 : -1;
        const double along[3] = {forward * reference.ex[e], forward * reference.ey[e],
                                 forward * reference.ez[e]};
        // Loops run counter-clockwise: outside lies to the right. An edge
        // without direction gives a zero side, which clips nothing.
        double side[3];
        cross(along, normal, side);
        double from[3], to[3];
        vertex(reference, ends.from, from);
        vertex(reference, ends.to, to);
        const double offset = std::max(dot(side, from), dot(side, to));
        bool any_outside = false;
        for (Corner &corner : polygon) {
            corner.out = dot(side, corner.x) - offset;
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
                for (int c = 0; c < 3; ++c) {
                    corner.x[c] = here.x[c] + share * (next.x[c] - here.x[c]);
                }
                corner.id = crossing(here.edge, e);
                corner.edge = inside ? (SIDE | e) : here.edge;
                clipped.push_back(corner);
            }
        }
        std::swap(polygon, clipped);
    }
    for (const Corner &corner : polygon) {
        const double gap =
            dot(normal, corner.x) - static_cast<double>(reference.offset[reference_face]);
        if (gap <= margin) {
            scratch.points.push_back({{corner.x[0], corner.x[1], corner.x[2]}, gap, corner.id});
        }
    }
}

int reduce_points(std::vector<ClipPoint> &points, const double normal[3], double margin,
                  double slack, const std::uint32_t *known, int known_count) {
    const int count = static_cast<int>(points.size());
    const auto is_known = [&](const ClipPoint &p) {
        return std::find(known, known + known_count, p.id) != known + known_count;
    };
    // The more a point is in touch, the more it counts.
    const auto weight = [&](const ClipPoint &p) {
        const double far = std::clamp(p.gap / margin, 0.0, 1.0);
        return (1 - 0.5 * far) * (is_known(p) ? CHOICE_SLACK : 1);
    };
    const auto area = [&](const ClipPoint &a, const ClipPoint &b, const ClipPoint &c) {
        double ab[3], ac[3], turned[3];
        minus(b.x, a.x, ab);
        minus(c.x, a.x, ac);
        cross(ab, ac, turned);
        return dot(turned, normal);
    };
    const auto square = [&](const ClipPoint &a, const ClipPoint &b) {
        double ab[3];
        minus(b.x, a.x, ab);
        return dot(ab, ab);
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
    pick(0, -1e300, [&](const ClipPoint &p) { return -p.gap + (is_known(p) ? slack : 0); });
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

int keep_points(std::vector<ClipPoint> &points, double slack, const std::uint32_t *known,
                int known_count) {
    const auto rest = std::stable_partition(points.begin(), points.end(), [&](const ClipPoint &p) {
        return std::find(known, known + known_count, p.id) != known + known_count;
    });
    // Ids may repeat.
    int kept = std::min(MOST_POINTS, static_cast<int>(rest - points.begin()));
    const int most = std::max(kept, std::min(4, static_cast<int>(points.size())));
    const auto apart = [&](const ClipPoint &p) {
        double nearest = 1e300;
        for (int i = 0; i < kept; ++i) {
            double d[3];
            minus(p.x, points[i].x, d);
            nearest = std::min(nearest, dot(d, d));
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

EdgeContact edge_contact(const HullData &a, int edge_a, const HullData &b, int edge_b,
                         const Rigid &pose) {
    EdgeContact out{};
    const HullEdge &ends_a = a.edge[edge_a];
    const HullEdge &ends_b = b.edge[edge_b];
    const double along_a[3] = {a.ex[edge_a], a.ey[edge_a], a.ez[edge_a]};
    const double local_b[3] = {b.ex[edge_b], b.ey[edge_b], b.ez[edge_b]};
    double along_b[3], n[3];
    pose.turn(local_b, along_b);
    cross(along_a, along_b, n);
    const double square = dot(n, n);
    if (square < PARALLEL) {
        return out;
    }
    double left[3], right[3];
    face_normal(a, ends_a.left, left);
    face_normal(a, ends_a.right, right);
    double length = std::sqrt(square);
    length = dot(n, left) + dot(n, right) < 0 ? -length : length;
    double from_a[3], to_a[3], from_b[3], to_b[3], local[3];
    vertex(a, ends_a.from, from_a);
    vertex(a, ends_a.to, to_a);
    vertex(b, ends_b.from, local);
    pose.apply(local, from_b);
    vertex(b, ends_b.to, local);
    pose.apply(local, to_b);
    // Where two segments come closest (Ericson, "Real-Time Collision
    // Detection", 2005, section 5.1.9): the points of the lines that face each
    // other, moved to the ends where they lie beyond, one after the other, so
    // that edges that are nearly parallel meet beside each other.
    double apart[3], span_a[3], span_b[3], turned[3];
    minus(from_b, from_a, apart);
    minus(to_a, from_a, span_a);
    minus(to_b, from_b, span_b);
    const double length_a = std::max(0.0, dot(span_a, along_a));
    const double length_b = std::max(0.0, dot(span_b, along_b));
    const double cosine = dot(along_a, along_b);
    cross(apart, along_b, turned);
    double at_a = std::clamp(dot(turned, n) / square, 0.0, length_a);
    const double at_b = std::clamp(at_a * cosine - dot(apart, along_b), 0.0, length_b);
    at_a = std::clamp(at_b * cosine + dot(apart, along_a), 0.0, length_a);
    for (int i = 0; i < 3; ++i) {
        out.axis[i] = n[i] / length;
        out.on_a[i] = from_a[i] + at_a * along_a[i];
        out.on_b[i] = from_b[i] + at_b * along_b[i];
    }
    minus(out.on_b, out.on_a, apart);
    out.gap = dot(out.axis, apart);
    out.off = std::sqrt(std::max(0.0, dot(apart, apart) - out.gap * out.gap));
    out.defined = true;
    return out;
}

} // namespace pluvia
