// The contact of a sphere with a sphere or a convex polyhedron: one point, where the two are
// closest.
#pragma once

#include "hull_pair.h"

namespace pluvia {

// Where the surface of a body is closest to a point outside, or, for a point inside, where the
// face of least penetration is. In the body's frame.
struct Closest {
    double distance; // of the point from the surface, negative inside
    Vec normal;      // out of the body, towards a point outside
    Vec on;          // on the surface
};

// Of a body of any shape. Exact, unless `distance` is found to be more than `enough`: then it
// is a lower bound, and `normal` and `on` are those of a face's plane.
Closest closest(const HullData &hull, const Vec &point, double enough);

// The contact of a pair in which at least one is a sphere, as `collide_hulls` finds that of hulls:
// at most one point, with the exact gap. Returns the gap of a pair without contact, or a lower
// bound of it.
//
// Bodies that are farther apart than the speculative margin without what they approach in the step
// get the normal with which they will meet, if nothing else stops them, or else pass each other:
// with that of now, a sphere would be stopped by a plane where it will find no sphere.
//
// A pair of spheres has nothing to remember but its point.
double collide_sphere(const PairCase &pair);

} // namespace pluvia
