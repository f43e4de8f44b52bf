// What a pair of hulls remembers from step to step.
#pragma once

#include "hull_axis.h"

#include <algorithm>

namespace pluvia {

// What touches.
enum class Feature : std::uint8_t { None, FaceOfA, FaceOfB, Edges };

// The bits of the number of a face, an edge or a corner where two are packed into one number.
constexpr std::uint32_t INDEX_BITS = 14;
constexpr std::uint32_t INDEX = (1U << INDEX_BITS) - 1;

// Faces, edges or corners that a hull has at most: beyond, packed numbers would repeat. The last
// two numbers are no edge's: they name the point of a sphere and the closest one of rounded bodies.
constexpr std::uint32_t MOST_NUMBERED = INDEX - 1;

// A kind and the numbers of two faces, edges or corners in one number.
constexpr std::uint32_t packed(std::uint32_t kind, std::uint32_t first, std::uint32_t second) {
    return kind << 2 * INDEX_BITS | (first & INDEX) << INDEX_BITS | (second & INDEX);
}

// What touched in a step; 0 for nothing.
constexpr std::uint32_t packed(Feature feature, std::int32_t first, std::int32_t second) {
    return packed(static_cast<std::uint32_t>(feature), static_cast<std::uint32_t>(first),
                  static_cast<std::uint32_t>(second));
}

// The highest bits of a point's id say which kind of feature it came from: a face of A (ClipPoint
// in hull_clip.h has the rest), the same of B, or edges of A and B, whose numbers follow.
constexpr std::uint32_t FROM_FACE_OF_B = 1U << 30;
constexpr std::uint32_t FROM_EDGES = packed(3, 0, 0);

// What a point is, which its id says, too: a corner of the body that meets the reference face,
// where an edge of that body crosses a side of the face, a corner of the face itself, or where two
// edges meet (or bodies that are round).
enum class PointOf : std::uint32_t { Corner, Crossing, CornerOfFace, Edges };
constexpr PointOf point_of(std::uint32_t id) {
    return static_cast<PointOf>(id >> 2 * INDEX_BITS & 3U);
}
constexpr std::uint32_t packed(PointOf what, std::uint32_t first, std::uint32_t second) {
    return packed(static_cast<std::uint32_t>(what), first, second);
}

// Points that a contact may have: four hold bodies at rest, and more are there where further
// corners may touch before points are found again, the more the faster bodies meet.
constexpr int MOST_POINTS = 8;

struct PairPoint {
    Vec on_a; // in A's frame
    Vec on_b; // in B's frame
    double gap;
    std::uint32_t id;
};

// A packed feature, and the id of a point, as the same contact has them when A and B change places.
std::uint32_t swapped_feature(std::uint32_t feature);
std::uint32_t swapped_id(std::uint32_t id);

struct PairContact {
    int count = 0;
    std::uint32_t feature = 0; // packed
    bool held = false;         // the same points as in the last step
    Vec normal{0, 0, 0};       // out of A towards B, in the world
    PairPoint points[MOST_POINTS];
};

// A contact as its pair keeps it: in single precision, which the solver reads it in anyway. There
// are many more pairs than fit into a cache, and all are read in every step. A point that stays
// where it is on its bodies is not rounded anew.
struct KeptPoint {
    float on_a[3] = {0, 0, 0};
    float on_b[3] = {0, 0, 0};
    float gap = 0;
    std::uint32_t id = 0;
};

struct KeptContact {
    std::int32_t count = 0;
    std::uint32_t feature = 0;
    float normal[3] = {0, 0, 0};
    KeptPoint points[MOST_POINTS];

    void keep(const PairContact &contact);
    // Whether one of its points has this id.
    bool has(std::uint32_t id) const {
        return std::any_of(points, points + count, [id](const KeptPoint &p) { return p.id == id; });
    }
};

// What a pair remembers.
struct PairMemory {
    Feature feature = Feature::None; // of the last step
    bool has_axis = false;           // an axis along which the pair was apart
    bool recalled = false;           // nothing but the feature is known yet
    std::int32_t first = -1;         // the face, or the edge of A
    std::int32_t second = -1;        // the incident face, or the edge of B
    float axis[3] = {0, 0, 0};       // in A's frame, out of A
    // Of the last whole search: no axis had a wider gap than this when B was
    // here in A's frame, or A in B's, whichever is the smaller body. Of a pair
    // that is apart: how far in this step, along the axis.
    float widest = 0;
    Relative pose = {};
    // Of a face contact: where the smaller body was in the frame of the larger
    // when its points were found.
    Relative met_at = {};
    // And the speculative margin with which they were found.
    float met_margin = 0;
    // The same face's plane, a copy beside the points: while they stay, nothing
    // else is read of the hulls, which may be far away in memory.
    float plane_normal[3] = {0, 0, 0};
    float plane_offset = 0;
    // The contact of the last step, which who calls puts here. At the end: of most
    // pairs only the first points are ever read.
    KeptContact last;

    // Nothing touches any more, and no axis is known.
    void let_go() {
        feature = Feature::None;
        has_axis = false;
        recalled = false;
    }
};

// How far any point of a body can have come from one place to another: |t - t'| +
// |R - R'| radius, the norm of the difference of two rotations being its
// Frobenius norm over the root of 2.
float farthest_displacement(const Relative &from, const Relative &to, float radius);

// Makes a pair that has no memory remember what touched, as another pair of the same hulls found
// it; the points are for `last`. What does not fit the hulls is not taken.
void recall(const HullData &a, const HullData &b, std::uint32_t feature, PairMemory &memory);

} // namespace pluvia
