// Separating axes of two hulls: how far they are apart, or how deep in each
// other, along the axes that can matter.
//
// For a unit vector n out of A the gap is the lowest point of B minus the highest point of A along
// n. The smallest translation that parts two overlapping hulls is the widest (least negative) gap
// over all n, and it is met at a face normal of A, a reversed face normal of B, or the normal of an
// edge of A and an edge of B whose arcs on the Gauss sphere cross (van den Bergen, "Collision
// Detection in Interactive 3D Environments", 2004; Gregorius, "The Separating Axis Test between
// Convex Polyhedra", GDC 2013).
//
// Everything here is in the frame of A, in single precision; a gap is always taken from true
// supports, so that no axis, however badly conditioned, can claim more room than there is.
#pragma once

#include "hull_data.h"

#include <memory>

namespace pluvia {

// From B's frame to A's: x_a = r x_b + t, r row by row.
struct Relative {
    float r[9];
    float t[3];
};

// Buffers of one thread; grown to the largest pair that it has seen.
class AxisScratch {
  public:
    void fit(const HullData &a, const HullData &b) {
        if (a.vertices > vertices_ || b.vertices > vertices_ || a.faces > faces_ ||
            b.faces > faces_ || a.edges > edges_ || b.edges > edges_) {
            grow(a, b);
        }
    }

    // B in A's frame.
    float *bx, *by, *bz;
    float *bnx, *bny, *bnz, *boffset;
    Vec normal_b(int face) const { return {bnx[face], bny[face], bnz[face]}; }
    // Gap along each face normal of A, and along each reversed one of B.
    float *gap_a, *gap_b;
    // Which vertices lie close enough to the best face planes.
    std::int32_t *near_a, *near_b;
    // Edges close enough: of A twelve values each (a point, the direction,
    // both normals), of B the same as twelve arrays of `stride`.
    float *edges_a, *edges_b;
    std::uint16_t *list_a, *list_b;
    int stride = 0;

  private:
    void grow(const HullData &a, const HullData &b);
    std::unique_ptr<LaneRoom[]> block_;
    int vertices_ = 0;
    int faces_ = 0;
    int edges_ = 0;
};

// Widest gap along the faces of either hull.
struct FaceGaps {
    float gap_a, gap_b;
    int face_a, face_b;
};

// An edge of A and an edge of B with their common normal out of A.
struct EdgeGap {
    int edge_a = -1, edge_b = -1; // -1: none better than what was asked for
    float gap = 0;                // along the normal, from true supports
    float axis[3] = {0, 0, 0};
};

// The same source compiled for the processors at hand; all give the same bits.
struct AxisKernels {
    // Gap along one axis, given in A's frame and in B's; `shift` is the
    // position of B's origin relative to A's along it.
    float (*gap_along)(const HullData &a, const HullData &b, const float axis_a[3],
                       const float axis_b[3], float shift);
    // Gaps along all faces; fills B in A's frame and the gaps in `scratch`.
    void (*faces)(const HullData &a, const HullData &b, const Relative &pose, AxisScratch &scratch,
                  FaceGaps &out);
    // The pair of edges with the widest gap above `best`, after `faces`. Ends
    // early with one wider than `enough`.
    //
    // With `depth` zero or more, only edges that can touch when the hulls are moved by at most
    // `depth` along their axis: exact for gaps from -depth to depth. Seen from a face of A with gap
    // g, all of B lies above g and all of A below 0. Let x on the edge of A and y = x + s n on the
    // edge of B be the points that face each other, |s| <= depth. Then x is not lower than
    // g - depth, y not higher than depth. Likewise seen from a face of B. Below zero: all edges.
    void (*edges)(const HullData &a, const HullData &b, const Relative &pose, const FaceGaps &faces,
                  float best, float enough, float depth, AxisScratch &scratch, EdgeGap &out);
    // The box of a hull turned by `r`, row by row, around its origin.
    void (*box)(const HullData &hull, const float r[9], float low[3], float high[3]);
};

// Whether this machine has AVX2.
bool has_avx2();

// The fastest that this processor runs, or the one that runs everywhere.
const AxisKernels &axis_kernels(bool runs_everywhere);

} // namespace pluvia
