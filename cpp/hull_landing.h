// Corners that land in a step beside the points of a contact.
//
// A face contact has points of one face of either body, at most four. A body that
// meets another fast, and turns in doing so, lands on corners that are none of them,
// and would be caught a step late, beyond the surface by what they came in between.
#pragma once

#include "hull_clip.h"

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
// MOST_POINTS: those that are less than `margin` above it now or at the end of the
// step and not within `slack` of a point that is there, the lowest first. Returns how
// many points there are now.
int add_landing(const Landing &landing, double margin, double slack, std::vector<ClipPoint> &points,
                int count);

// The lowest corner above a reference face, wherever it lies beside it. `pose` leads
// from the incident hull's frame to the reference hull's.
ClipPoint lowest_corner(const HullData &reference, int face, const HullData &incident,
                        const Rigid &pose);

} // namespace pluvia
