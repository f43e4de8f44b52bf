// The contact of rounded polyhedra with each other and with polyhedra: their cores' distance less
// the radii.
#pragma once

#include "hull_pair.h"

namespace pluvia {

// The contact of two polyhedra of which one at least is rounded, as `collide_hulls` finds that of
// hulls. Returns the gap of a pair without contact, or a lower bound of it.
//
// Where the cores are closest along the normal of a face, the contact is up to four points of that
// face and the one that meets it, with their gaps along its normal, held and named as those of
// hulls. Elsewhere it is the one point where the bodies are closest, exact, and where the bodies
// lie almost flat on each other, points of the face beside it. Cores that overlap are parted along
// the axis on which they are least deep, in one point.
//
// Bodies that are farther apart than the speculative margin without what they approach in the step
// get the contact with which they will meet, as spheres do.
double collide_rounded(const PairCase &pair);

} // namespace pluvia
