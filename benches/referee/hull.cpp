// Finds where two convex polyhedra touch, by trying every face and every pair of edges.
#include "hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace referee {

namespace {

// An axis between edges must separate by so much more than one of a face, in m,
// to be preferred: edges that lie in touching faces have the same axis, and
// faces touch in more points.
constexpr double EDGE_HANDICAP = 1e-6;

// Gaps in m that differ by less are one.
constexpr double SAME_GAP = 1e-9;

constexpr double FAR = std::numeric_limits<double>::infinity();

Vec3 face_normal(const std::vector<Vec3> &vertices, const std::vector<int> &face) {
    Vec3 sum = Vec3::Zero();
    const Vec3 &first = vertices[static_cast<std::size_t>(face[0])];
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
        const Vec3 a = vertices[static_cast<std::size_t>(face[i])] - first;
        const Vec3 b = vertices[static_cast<std::size_t>(face[i + 1])] - first;
        sum += a.cross(b);
    }
    return sum.normalized();
}

struct Axis {
    double separation = -FAR;
    Vec3 normal = Vec3::Zero();          // from B to A
    int kind = 0, first = 0, second = 0; // 0: face of A, 1: face of B, 2: edges
};

// Faces of `reference` against the vertices of `other`. `all`, or null, gets every axis.
void ask_faces(const Placed &reference, const Placed &other, int kind, double enough, Axis &best,
               std::vector<Axis> *all = nullptr) {
    for (std::size_t f = 0; f < reference.normals.size(); ++f) {
        double least = FAR;
        for (const Vec3 &v : other.vertices) {
            least = std::min(least, reference.normals[f].dot(v));
        }
        const double separation = least - reference.offsets[f];
        const Vec3 normal = kind == 0 ? Vec3(-reference.normals[f]) : reference.normals[f];
        const Axis axis = {separation, normal, kind, static_cast<int>(f), 0};
        if (all != nullptr) {
            all->push_back(axis);
        }
        if (separation > best.separation) {
            best = axis;
            if (separation > enough) {
                return;
            }
        }
    }
}

// Of each edge of the one, edge by edge, its component along each normal of the other.
std::vector<double> components(const Placed &edges, const Placed &faces) {
    std::vector<double> all;
    all.reserve(edges.directions.size() * faces.normals.size());
    for (const Vec3 &direction : edges.directions) {
        for (const Vec3 &normal : faces.normals) {
            all.push_back(normal.dot(direction));
        }
    }
    return all;
}

// Edges that make a face of the Minkowski difference: their arcs on the sphere
// of normals cross.
void ask_edges(const Placed &a, const Placed &b, double enough, Axis &best,
               std::vector<Axis> *all = nullptr) {
    const double to_beat = best.separation + EDGE_HANDICAP;
    Axis edges;
    edges.separation = to_beat;
    const std::vector<double> of_a = components(a, b), of_b = components(b, a);
    const std::size_t faces_of_a = a.normals.size(), faces_of_b = b.normals.size();
    for (std::size_t i = 0; i < a.directions.size(); ++i) {
        const Hull::Edge &ea = a.hull->edges[i];
        const auto left = static_cast<std::size_t>(ea.left);
        const auto right = static_cast<std::size_t>(ea.right);
        const double *along_normals_of_b = &of_a[i * faces_of_b];
        for (std::size_t j = 0; j < b.directions.size(); ++j) {
            const Hull::Edge &eb = b.hull->edges[j];
            // Normals of B count reversed.
            const double cba = -along_normals_of_b[eb.left], dba = -along_normals_of_b[eb.right];
            if (cba * dba >= 0) {
                continue;
            }
            const double *along_normals_of_a = &of_b[j * faces_of_a];
            const double adc = along_normals_of_a[left], bdc = along_normals_of_a[right];
            if (adc * bdc >= 0 || cba * bdc <= 0) {
                continue;
            }
            const Vec3 &da = a.directions[i], &db = b.directions[j];
            const Vec3 &pa = a.vertices[static_cast<std::size_t>(ea.from)];
            Vec3 normal = da.cross(db);
            const double size = normal.norm();
            if (size < 1e-6 * da.norm() * db.norm()) {
                continue;
            }
            normal /= size;
            if (normal.dot(pa - a.centre) > 0) {
                normal = -normal;
            }
            const double separation =
                normal.dot(pa - b.vertices[static_cast<std::size_t>(eb.from)]);
            const Axis axis = {separation, normal, 2, static_cast<int>(i), static_cast<int>(j)};
            if (all != nullptr) {
                all->push_back(axis);
            }
            if (separation > edges.separation) {
                edges = axis;
                if (separation > enough) {
                    break;
                }
            }
        }
    }
    if (edges.separation > to_beat) {
        best = edges;
    }
}

Axis best_axis(const Placed &a, const Placed &b, double enough) {
    Axis best;
    ask_faces(a, b, 0, enough, best);
    if (best.separation <= enough) {
        ask_faces(b, a, 1, enough, best);
    }
    if (best.separation <= enough) {
        ask_edges(a, b, enough, best);
    }
    return best;
}

struct Corner {
    Vec3 at;
    std::uint32_t incident, side; // vertex or edge of the one, side of the other
};

std::uint64_t key_of(int kind, std::uint64_t first, std::uint64_t second, std::uint64_t third) {
    return (static_cast<std::uint64_t>(kind) << 60) | (first << 40) | (second << 20) | third;
}

// The incident face within the prism over the reference face.
void clip(const Placed &reference, int face, const Placed &other, const Axis &axis, double margin,
          std::vector<Touch> &out) {
    const auto f = static_cast<std::size_t>(face);
    const Vec3 &normal = reference.normals[f];
    std::size_t incident = 0;
    for (std::size_t i = 1; i < other.normals.size(); ++i) {
        if (other.normals[i].dot(normal) < other.normals[incident].dot(normal)) {
            incident = i;
        }
    }
    std::vector<Corner> polygon, next;
    for (const int v : other.hull->faces[incident]) {
        polygon.push_back(
            {other.vertices[static_cast<std::size_t>(v)], static_cast<std::uint32_t>(v), 0});
    }
    const auto &loop = reference.hull->faces[f];
    for (std::size_t i = 0; i < loop.size() && !polygon.empty(); ++i) {
        const Vec3 &from = reference.vertices[static_cast<std::size_t>(loop[i])];
        const Vec3 &to = reference.vertices[static_cast<std::size_t>(loop[(i + 1) % loop.size()])];
        const Vec3 outward = (to - from).cross(normal);
        next.clear();
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Corner &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
            const double dp = outward.dot(p.at - from), dq = outward.dot(q.at - from);
            if (dp <= 0) {
                next.push_back(p);
            }
            if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
                const Vec3 cut = p.at + (q.at - p.at) * (dp / (dp - dq));
                const bool in = dp < 0;
                next.push_back({cut, (in ? p : q).incident,
                                static_cast<std::uint32_t>(2 * i + 1 + (in ? 1 : 0))});
            }
        }
        polygon.swap(next);
    }
    const std::size_t before = out.size();
    const double sign = axis.kind == 0 ? -1 : 1;
    const auto add = [&](const Vec3 &at, std::uint32_t vertex, std::uint32_t side) {
        const double gap = normal.dot(at) - reference.offsets[f];
        if (gap <= margin) {
            out.push_back(
                {at - normal * (gap / 2), sign * normal, gap, key_of(axis.kind, f, vertex, side)});
        }
    };
    for (const Corner &c : polygon) {
        add(c.at, c.incident, c.side);
    }
    // The nearest vertex may lie in another face than the incident one, or beside the prism.
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < other.vertices.size(); ++i) {
        if (normal.dot(other.vertices[i]) < normal.dot(other.vertices[nearest])) {
            nearest = i;
        }
    }
    const double least = normal.dot(other.vertices[nearest]) - reference.offsets[f];
    const bool there = std::any_of(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(),
                                   [&](const Touch &t) { return t.gap <= least + SAME_GAP; });
    if (!there) {
        add(other.vertices[nearest], static_cast<std::uint32_t>(nearest), 0);
    }
}

// Where the lines through two edges come nearest.
void cross(const Placed &a, const Placed &b, const Axis &axis, std::vector<Touch> &out) {
    const auto i = static_cast<std::size_t>(axis.first), j = static_cast<std::size_t>(axis.second);
    const Vec3 &da = a.directions[i], &db = b.directions[j];
    const Vec3 &pa = a.vertices[static_cast<std::size_t>(a.hull->edges[i].from)];
    const Vec3 &pb = b.vertices[static_cast<std::size_t>(b.hull->edges[j].from)];
    const double aa = da.dot(da), bb = db.dot(db), ab = da.dot(db);
    const double ar = da.dot(pa - pb), br = db.dot(pa - pb);
    const double det = aa * bb - ab * ab;
    const double s = std::clamp((ab * br - bb * ar) / det, 0.0, 1.0);
    const double t = std::clamp((aa * br - ab * ar) / det, 0.0, 1.0);
    out.push_back(
        {0.5 * (pa + s * da + pb + t * db), axis.normal, axis.separation, key_of(2, i, j, 0)});
}

} // namespace

Hull::Hull(std::vector<Vec3> vertices_in, std::vector<std::vector<int>> faces_in)
    : vertices(std::move(vertices_in)), faces(std::move(faces_in)) {
    std::map<std::pair<int, int>, int> half;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (std::size_t i = 0; i < faces[f].size(); ++i) {
            const int from = faces[f][i], to = faces[f][(i + 1) % faces[f].size()];
            half[{from, to}] = static_cast<int>(f);
        }
    }
    for (const auto &[ends, left] : half) {
        if (ends.first < ends.second) {
            const auto right = half.find({ends.second, ends.first});
            if (right == half.end()) {
                throw std::runtime_error("a hull is not closed");
            }
            edges.push_back({ends.first, ends.second, left, right->second});
        }
    }
    for (const Vec3 &v : vertices) {
        radius = std::max(radius, v.norm());
    }
}

Hull Hull::box(const Vec3 &sides) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
        const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
        corners.emplace_back(0.5 * sides.cwiseProduct(sign));
    }
    return {corners,
            {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
}

void Placed::place(const Hull &of, const Vec3 &position, const Quat &rotation) {
    hull = &of;
    centre = position;
    const Mat3 turn = rotation.toRotationMatrix();
    vertices.resize(of.vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        vertices[i] = turn * of.vertices[i] + position;
    }
    normals.resize(of.faces.size());
    offsets.resize(of.faces.size());
    for (std::size_t f = 0; f < normals.size(); ++f) {
        normals[f] = face_normal(vertices, of.faces[f]);
        offsets[f] = -FAR;
        for (const int v : of.faces[f]) {
            offsets[f] =
                std::max(offsets[f], normals[f].dot(vertices[static_cast<std::size_t>(v)]));
        }
    }
    directions.resize(of.edges.size());
    for (std::size_t e = 0; e < directions.size(); ++e) {
        directions[e] = vertices[static_cast<std::size_t>(of.edges[e].to)] -
                        vertices[static_cast<std::size_t>(of.edges[e].from)];
    }
}

namespace {

void touches_along(const Axis &axis, const Placed &a, const Placed &b, double margin,
                   std::vector<Touch> &out) {
    if (axis.kind == 0) {
        clip(a, axis.first, b, axis, margin, out);
    } else if (axis.kind == 1) {
        clip(b, axis.first, a, axis, margin, out);
    } else {
        cross(a, b, axis, out);
    }
}

} // namespace

void touches(const Placed &a, const Placed &b, double margin, std::vector<Touch> &out,
             double doubt) {
    const double reach = a.hull->radius + b.hull->radius + margin;
    if ((a.centre - b.centre).squaredNorm() > reach * reach) {
        return;
    }
    const Axis axis = best_axis(a, b, margin);
    if (axis.separation > margin) {
        return;
    }
    touches_along(axis, a, b, margin, out);
    if (doubt <= 0) {
        return;
    }
    Axis best;
    std::vector<Axis> all;
    ask_faces(a, b, 0, FAR, best, &all);
    ask_faces(b, a, 1, FAR, best, &all);
    ask_edges(a, b, FAR, best, &all);
    const double least = axis.separation - std::max(doubt, -axis.separation);
    for (const Axis &other : all) {
        const bool same =
            other.kind == axis.kind && other.first == axis.first && other.second == axis.second;
        if (!same && other.separation >= least) {
            touches_along(other, a, b, margin, out);
        }
    }
}

void touches(const Placed &a, const Plane &b, double margin, std::vector<Touch> &out) {
    if (b.normal.dot(a.centre) - b.offset > a.hull->radius + margin) {
        return;
    }
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
        const double gap = b.normal.dot(a.vertices[i]) - b.offset;
        if (gap <= margin) {
            out.push_back(
                {a.vertices[i] - b.normal * (gap / 2), b.normal, gap, key_of(3, 0, i, 0)});
        }
    }
}

double separation(const Placed &a, const Placed &b) { return best_axis(a, b, FAR).separation; }

} // namespace referee
