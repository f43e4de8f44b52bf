// Where two convex polyhedra that are apart come closest, exactly: also corner to corner and
// corner to edge, which no separating axis of faces and edges tells.
//
// The algorithm of Gilbert, Johnson and Keerthi (1988), in double precision, from the same
// beginning whatever was before: the same poses give the same bits.
#pragma once

#include "hull_clip.h"

namespace pluvia {

struct CoreDistance {
    double distance; // 0 for polyhedra that overlap, a lower bound for more than `enough` apart
    Vec axis;        // unit vector from A to B, in A's frame
    Vec on_a, on_b;  // in A's frame
    bool apart;      // false where they overlap, or nearly: then nothing else is known
};

// `b_to_a` leads from B's frame to A's.
CoreDistance core_distance(const HullData &a, const HullData &b, const Rigid &b_to_a,
                           double enough);

} // namespace pluvia
