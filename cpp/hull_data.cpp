// Lays out vertices, faces and edges of a convex polyhedron for the hull–hull test, and checks that
// its surface is closed.
#include "hull_data.h"

#include "hull_memory.h"
#include "pluvia/src/world/bullet/ffi.rs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace pluvia {

namespace {

// Cosine between an edge and the normals of its faces up to which the edge's
// end points are taken to say its direction. Vertices are merged at 1e-6 of
// the grain's size, so that an edge hardly longer than that may point anywhere.
constexpr double SKEW = 1e-4;
// Sine of the angle between two face normals from which their cross product
// says the direction of the edge where its end points do not.
constexpr double SHARP = 1e-2;

// Unit vector, or zero for a zero vector.
Vec unit(const Vec &a) { return length(a) > 0 ? a / length(a) : Vec{0, 0, 0}; }

std::size_t aligned(std::size_t bytes) {
    return (bytes + sizeof(LaneRoom) - 1) / sizeof(LaneRoom) * sizeof(LaneRoom);
}

// An edge found while walking round the faces.
struct Half {
    std::uint16_t face;
    std::size_t place; // in loop_vertex
};

} // namespace

HullData::HullData(const ShapeDefinition &shape, double scale) : rounding(shape.radius * scale) {
    const double *const coordinates = shape.coordinates.data();
    const std::uint32_t *const face_starts = shape.face_starts.data();
    const std::uint32_t *const face_vertices = shape.face_vertices.data();
    const std::size_t vertex_count = shape.coordinates.size() / 3;
    const std::size_t face_count = shape.face_starts.size() - 1;
    const std::size_t loop_length = shape.face_vertices.size();
    const std::size_t edge_count = loop_length / 2;
    if (std::max({vertex_count, face_count, edge_count}) > MOST_NUMBERED) {
        throw std::runtime_error("a hull has " + std::to_string(vertex_count) + " vertices, " +
                                 std::to_string(face_count) + " faces and " +
                                 std::to_string(edge_count) + " edges, at most " +
                                 std::to_string(MOST_NUMBERED) + " of each are possible");
    }
    // Every edge is met twice, once in each direction.
    std::map<std::pair<std::uint32_t, std::uint32_t>, Half> halves;
    for (std::size_t f = 0; f < face_count; ++f) {
        for (std::uint32_t k = face_starts[f]; k < face_starts[f + 1]; ++k) {
            const std::uint32_t next = k + 1 < face_starts[f + 1] ? k + 1 : face_starts[f];
            const std::uint32_t from = face_vertices[k], to = face_vertices[next];
            const bool fresh =
                halves.insert({{from, to}, {static_cast<std::uint16_t>(f), k}}).second;
            if (!fresh || from == to || from >= vertex_count) {
                throw std::runtime_error("the faces of a hull do not form a closed surface");
            }
        }
    }
    for (const auto &half : halves) {
        if (halves.count({half.first.second, half.first.first}) == 0) {
            throw std::runtime_error("the faces of a hull do not form a closed surface");
        }
    }
    vertices = static_cast<int>(vertex_count);
    faces = static_cast<int>(face_count);
    edges = static_cast<int>(edge_count);
    allocate(static_cast<int>(loop_length));
    for (int v = 0; v < vertices; ++v) {
        vx[v] = static_cast<float>(coordinates[3 * v] * scale);
        vy[v] = static_cast<float>(coordinates[3 * v + 1] * scale);
        vz[v] = static_cast<float>(coordinates[3 * v + 2] * scale);
        radius = std::max(radius, std::sqrt(vx[v] * vx[v] + vy[v] * vy[v] + vz[v] * vz[v]));
    }
    radius += static_cast<float>(rounding);
    std::vector<std::vector<std::uint16_t>> around(vertex_count);
    for (std::size_t f = 0; f <= face_count; ++f) {
        loop_start[f] = static_cast<std::uint16_t>(face_starts[f]);
    }
    for (std::size_t f = 0; f < face_count; ++f) {
        for (std::uint32_t k = face_starts[f]; k < face_starts[f + 1]; ++k) {
            loop_vertex[k] = static_cast<std::uint16_t>(face_vertices[k]);
            around[face_vertices[k]].push_back(static_cast<std::uint16_t>(f));
        }
    }
    std::uint16_t e = 0;
    for (const auto &[ends, half] : halves) {
        if (ends.first < ends.second) {
            const Half &back = halves.at({ends.second, ends.first});
            edge[e] = {static_cast<std::uint16_t>(ends.first),
                       static_cast<std::uint16_t>(ends.second), half.face, back.face};
            loop_edge[half.place] = loop_edge[back.place] = e;
            ++e;
        }
    }
    std::uint16_t filled = 0;
    for (std::size_t v = 0; v < vertex_count; ++v) {
        if (around[v].empty()) {
            throw std::runtime_error("a vertex of a hull is in no face");
        }
        around_start[v] = filled;
        for (const std::uint16_t f : around[v]) {
            around_face[filled++] = f;
        }
    }
    around_start[vertex_count] = filled;
    set_planes();
    set_edge_directions();
    pad();
}

HullData::HullData(double radius_of_sphere)
    : vertices(1), radius(static_cast<float>(radius_of_sphere)), sphere(radius_of_sphere) {
    allocate(0);
    vx[0] = vy[0] = vz[0] = 0;
    loop_start[0] = around_start[0] = around_start[1] = 0;
    pad();
}

void HullData::allocate(int loop_length) {
    const auto reals = [](int n) { return aligned(sizeof(float) * static_cast<std::size_t>(n)); };
    const auto words = [](int n) {
        return aligned(sizeof(std::uint16_t) * static_cast<std::size_t>(n));
    };
    const int v = padded(vertices);
    const int f = padded(faces);
    const int e = padded(edges);
    const std::size_t bytes = 3 * reals(v) + 4 * reals(f) + 3 * reals(e) + words(4 * edges) +
                              words(faces + 1) + 3 * words(loop_length) + words(vertices + 1);
    block_.reset(new LaneRoom[bytes / sizeof(LaneRoom)]);
    char *next = reinterpret_cast<char *>(block_.get());
    const auto take = [&next](auto *&array, std::size_t size) {
        array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(next);
        next += size;
    };
    for (float **array : {&vx, &vy, &vz}) {
        take(*array, reals(v));
    }
    for (float **array : {&nx, &ny, &nz, &offset}) {
        take(*array, reals(f));
    }
    for (float **array : {&ex, &ey, &ez}) {
        take(*array, reals(e));
    }
    take(edge, words(4 * edges));
    take(loop_start, words(faces + 1));
    take(loop_vertex, words(loop_length));
    take(loop_edge, words(loop_length));
    take(around_start, words(vertices + 1));
    take(around_face, words(loop_length));
}

void HullData::set_planes() {
    for (int f = 0; f < faces; ++f) {
        // Newell's normal: an area-weighted mean over all corners.
        const int begin = loop_start[f];
        const int end = loop_start[f + 1];
        const Vec origin = vertex(loop_vertex[begin]);
        Vec sum{0, 0, 0};
        for (int k = begin; k < end; ++k) {
            const int next = k + 1 < end ? k + 1 : begin;
            sum = sum + (vertex(loop_vertex[k]) - origin).cross(vertex(loop_vertex[next]) - origin);
        }
        const Vec n = unit(sum);
        if (!(n.dot(n) > 0)) {
            throw std::runtime_error("a face of a hull has no area");
        }
        nx[f] = static_cast<float>(n.x);
        ny[f] = static_cast<float>(n.y);
        nz[f] = static_cast<float>(n.z);
        double farthest = -std::numeric_limits<double>::infinity();
        for (int v = 0; v < vertices; ++v) {
            farthest = std::max(farthest, normal(f).dot(vertex(v)));
        }
        offset[f] = static_cast<float>(farthest);
    }
}

void HullData::set_edge_directions() {
    for (int e = 0; e < edges; ++e) {
        const HullEdge &ends = edge[e];
        const Vec left = normal(ends.left);
        const Vec right = normal(ends.right);
        Vec direction = unit(vertex(ends.to) - vertex(ends.from));
        const bool known =
            direction.dot(direction) > 0 &&
            std::max(std::abs(direction.dot(left)), std::abs(direction.dot(right))) <= SKEW;
        if (!known) {
            const Vec crossing = left.cross(right);
            // Nearly in one plane and nearly without length: the faces that
            // meet here are all that can be felt of it.
            direction = length(crossing) >= SHARP ? unit(crossing) : Vec{0, 0, 0};
        }
        ex[e] = static_cast<float>(direction.x);
        ey[e] = static_cast<float>(direction.y);
        ez[e] = static_cast<float>(direction.z);
    }
}

void HullData::pad() {
    for (int v = vertices; v < padded(vertices); ++v) {
        vx[v] = vx[0];
        vy[v] = vy[0];
        vz[v] = vz[0];
    }
    for (int f = faces; f < padded(faces); ++f) {
        nx[f] = ny[f] = nz[f] = 0;
        // Finite, so that no arithmetic on it makes a NaN.
        offset[f] = 1e30F;
    }
    for (int e = edges; e < padded(edges); ++e) {
        ex[e] = ey[e] = ez[e] = 0;
    }
}

} // namespace pluvia
