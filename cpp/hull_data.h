// A convex polyhedron as the narrow phase reads it: vertices, planes, edges
// with the faces that meet there, and loops of the faces. Or a sphere, whose centre is its one
// vertex. Or a rounded polyhedron: a core, which the arrays describe, swept by a ball.
//
// Built once, in double, from the exact polyhedron; kept in single precision, one array a
// component, aligned for vectors of eight. The rounded vertices are the body from then on: every
// later computation, in single or double, speaks of the same shape, which differs from the given
// one by 6e-8 of its size (a thousandth of a micrometre on a grain).
#pragma once

#include "three.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace pluvia {

struct ShapeDefinition;

// Lanes of the widest vectors that walk over the arrays; lengths are padded to it.
constexpr int LANES = 8;
constexpr int padded(int count) { return (count + LANES - 1) / LANES * LANES; }

// Memory for one number per lane. Blocks of arrays are made of it, so that each array is aligned.
struct alignas(sizeof(float) * LANES) LaneRoom {
    std::byte bytes[sizeof(float) * LANES];
};

struct HullEdge {
    std::uint16_t from, to;    // vertices; the left face's loop runs this way
    std::uint16_t left, right; // faces, seen from outside
};

class HullData {
  public:
    // A polyhedron, maybe swept by a ball, whose lists are sound, in engine units, of which `scale`
    // make a metre. Throws std::runtime_error for a surface that is not closed, a vertex in no
    // face, a face without area, or more vertices, faces or edges than MOST_NUMBERED
    // (hull_memory.h).
    HullData(const ShapeDefinition &shape, double scale);
    // A sphere about the origin.
    explicit HullData(double radius);

    int vertices = 0;
    int faces = 0;
    int edges = 0;
    float radius = 0;    // of the sphere about the origin that holds the hull
    double sphere = 0;   // radius of a sphere; 0 for a polyhedron
    double rounding = 0; // radius of the ball that sweeps the core; 0 for a polyhedron as it is

    // Vertices; the padding repeats the first.
    float *vx, *vy, *vz;
    // Planes: outward unit normal, and how far the body reaches along it (the
    // farthest vertex, which for a plane face is the face itself). The
    // padding has no normal and an offset that no gap survives.
    float *nx, *ny, *nz, *offset;
    // Unit direction of each edge, zero where it cannot be known.
    float *ex, *ey, *ez;
    HullEdge *edge;
    // Loop of face f: entries loop_start[f] up to loop_start[f + 1]; edge k of
    // the loop leads from its vertex k to the next.
    std::uint16_t *loop_start, *loop_vertex, *loop_edge;
    // Faces around vertex v: entries around_start[v] up to around_start[v + 1].
    std::uint16_t *around_start, *around_face;

    Vec vertex(int v) const { return {vx[v], vy[v], vz[v]}; }
    Vec normal(int f) const { return {nx[f], ny[f], nz[f]}; }
    Vec along(int e) const { return {ex[e], ey[e], ez[e]}; }
    // How far a point is above the plane of a face.
    double above(int f, const Vec &x) const {
        return normal(f).dot(x) - static_cast<double>(offset[f]);
    }
    // Out of a face beside one of its edges; 0 for an edge without direction. Loops run
    // counter-clockwise: outside lies to the right.
    Vec beside(int f, int e) const {
        return (along(e) * (edge[e].left == f ? 1.0 : -1.0)).cross(normal(f));
    }

    bool is_sphere() const { return sphere > 0; }
    bool is_rounded() const { return rounding > 0; }
    bool is_plain() const { return !is_sphere() && !is_rounded(); }
    // Of the sphere about the origin that holds what turns when the body does: what the ball of a
    // rounded one adds, or all of a sphere, looks where it did.
    float core_radius() const { return is_sphere() ? 0 : radius - static_cast<float>(rounding); }

    void prefetch_edge(int e) const {
        __builtin_prefetch(ex + e);
        __builtin_prefetch(ey + e);
        __builtin_prefetch(ez + e);
        __builtin_prefetch(edge + e);
    }

  private:
    std::unique_ptr<LaneRoom[]> block_;

    void allocate(int loop_length);
    void set_planes();
    void set_edge_directions();
    void pad();
};

} // namespace pluvia
