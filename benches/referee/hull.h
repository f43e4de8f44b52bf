// Convex polyhedra, and where two of them touch: the referee's own collision
// detection. Exhaustive over faces and edges, nothing remembered between calls.
#pragma once

#include "algebra.h"

#include <cstdint>

namespace referee {

struct Hull {
    struct Edge {
        int from, to;    // vertices
        int left, right; // faces
    };
    std::vector<Vec3> vertices;
    std::vector<std::vector<int>> faces; // counter-clockwise from outside
    std::vector<Edge> edges;
    double radius = 0; // about the origin

    Hull() = default;
    Hull(std::vector<Vec3> vertices, std::vector<std::vector<int>> faces);
    static Hull box(const Vec3 &sides);
};

// A hull at a pose, in world coordinates.
struct Placed {
    const Hull *hull = nullptr;
    Vec3 centre;
    std::vector<Vec3> vertices, normals, directions; // of vertices, faces, edges
    std::vector<double> offsets;                     // of the faces' planes

    void place(const Hull &hull, const Vec3 &position, const Quat &rotation);
};

// Inside where normal·x ≥ offset.
struct Plane {
    Vec3 normal;
    double offset = 0;
};

// A contact point. The normal leads from B to A, the point lies midway; the key
// says which features meet there and is the same while they are.
struct Touch {
    Vec3 point, normal;
    double gap = 0;
    std::uint64_t key = 0;
};

// All contact points of a pair with gaps up to `margin`: the whole polygon where
// faces meet, one point where edges cross. Nothing where the hulls are further
// apart. Gaps of hulls that overlap are negative. With a doubt, m, also along every
// other axis whose separation falls short of the largest by less than it, or than
// the overlap: which of them bears cannot be said from the places alone.
void touches(const Placed &a, const Placed &b, double margin, std::vector<Touch> &out,
             double doubt = 0);
void touches(const Placed &a, const Plane &b, double margin, std::vector<Touch> &out);

// Gap along the axis of largest separation: minus the depth of an overlap, and
// no more than the distance otherwise.
double separation(const Placed &a, const Placed &b);

} // namespace referee
