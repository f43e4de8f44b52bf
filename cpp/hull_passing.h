// Bodies that are about to meet along one axis, and slip past each other along another.
//
// A contact is found along the axis on which the bodies are farthest apart. A block that slides
// from one floor piece to the next is farthest from the next one's side, though it will only come
// over it: a contact there would stop it at a joint that cannot be felt ("ghost collisions" at
// inner edges). So where two faces will do, the one that the bodies hardly approach is taken.
#pragma once

#include "hull_axis.h"
#include "hull_clip.h"

namespace pluvia {

// Velocity of a body's origin and angular velocity, in the world.
struct HullMotion {
    Vec velocity, spin;
};

// Where the bodies go in a step if nothing stops them.
struct PairMotion {
    HullMotion a, b;
    double step;
};

// Where a body is after a time if nothing stops it: turned about its origin by its spin, and moved.
Rigid ahead(const Rigid &pose, const HullMotion &motion, double time);

// When two bodies meet within a step, by Newton's method on the gap, which is convex in time, or
// nearly: a tangent lies below it, so that no step passes the moment of meeting.
struct Meeting {
    double step;
    double time = 0, early = 0, late = step;
    int steps = 0;

    // Goes on from `time`, where the bodies are `gap` apart and close at a speed; false at the end.
    bool go_on(double gap, double closing);
};

struct PairCase;

// From B's frame to A's at the end of the step, if nothing stops the bodies.
Rigid b_to_a_ahead(const PairCase &pair);

// A face of A (`is_a`) or of B.
struct PairFace {
    bool is_a;
    int face;

    bool operator!=(const PairFace &o) const { return is_a != o.is_a || face != o.face; }
};

// The face that the bodies slide along: neither its gap nor its depth is more than the hysteresis,
// now and at the end of the step, and the gap shrinks by less than half of what the widest does.
// Where there is none, `found`: the face with the widest gap now. `scratch.axis` has the gaps of
// this moment, as `faces` of the kernels leaves them; `scratch.ahead` is written to.
PairFace passing_face(const PairCase &pair, const PairFace &found);

} // namespace pluvia
