// Points beside those of a contact.
//
// Four points of one face of either body hold the bodies. A body that meets another fast, and turns
// in doing so, lands on corners that are none of them, and would be caught a step late, beyond the
// surface by what they came in between. So would one that rocks about an edge from face to face:
// the face of the last step is kept while the other's corners are hardly lower. Under a load it
// would then rock for ever, pushed up each time.
//
// Edges give one point. Where their axis is nearly the normal of a face, the bodies lie
// almost flat on each other, and other corners are about to touch: with the one point
// alone a body rocks from one pair of edges to the next, is caught by each a step
// late, beyond the surface, and pushed up again, so that it may never come to rest.
#pragma once

#include "hull_memory.h"
#include "hull_passing.h"

namespace pluvia {

// What lands: corners of one hull on a face of another. `now` and `then` lead from the
// incident hull's frame to the reference hull's at the beginning of the step and, if
// nothing stops the bodies, at its end. New points get ids with `mark`.
struct Landing {
    const HullData &reference;
    int face;
    const HullData &incident;
    const Rigid &now;
    const Rigid &then;
    std::uint32_t mark;
};

// Adds corners over the reference face to the first `count` of `points`, until there are
// MOST_POINTS: those that are less than `margin` above it now or at the end of the step and not
// within `slack` of a point that is there, the lowest first. Returns how many points there are now.
int add_landing(const Landing &landing, double margin, double slack, std::vector<ClipPoint> &points,
                int count);

// The lowest corner above a reference face, wherever it lies beside it. `pose` leads
// from the incident hull's frame to the reference hull's.
ClipPoint lowest_corner(const HullData &reference, int face, const HullData &incident,
                        const Rigid &pose);

// The face that a contact of edges is almost one of: of those that meet in the edges, the one
// that looks most along the axis, of the body whose points `last` has if it has any. Face -1
// where none does. `b_to_a` leads from B's frame to A's.
PairFace flat_face(const HullData &a, int edge_a, const HullData &b, int edge_b, const Vec &axis,
                   const Rigid &b_to_a, const KeptContact &last);

// Where edges meet, in the frame of the reference hull, their gap, and the cosine
// between their axis and the normal of the face.
struct EdgesAt {
    Vec at;
    double gap;
    double cosine;
};

// Leaves of the points of that face those that are not within `near` of where the edges
// meet, with their gaps along the edges' axis. None is deeper than the edges: what is by
// up to `slack` is as deep, and what is deeper lies under another part of the surface. Nor
// is any so far from the face that the axis leads to a place farther off than that.
void keep_beside(const EdgesAt &edges, double near, double slack, std::vector<ClipPoint> &points);

} // namespace pluvia
