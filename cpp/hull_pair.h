// The contact of one pair of hulls (hull_pair.cpp), of a sphere (sphere_pair.cpp) or of a rounded
// polyhedron (rounded_pair.cpp) with another body, from their poses to at most MOST_POINTS points,
// with a memory from step to step.
//
// A pure computation: reads two bodies and their poses, writes the pair's own
// memory and result, and may therefore run for many pairs at once.
#pragma once

#include "hull_axis.h"
#include "hull_clip.h"
#include "hull_memory.h"
#include "hull_passing.h"

namespace pluvia {

// Lengths in engine units.
struct PairSettings {
    // Points are kept up to this gap.
    double speculative_margin;
    // How much of it is for what the bodies may come closer in the step.
    double approach;
    // Last step's feature is kept while no other has a gap wider by this.
    // Without it, features of nearly equal depth alternate, the solver's
    // impulses are thrown away, and a packing at rest creeps numerically.
    double hysteresis;
    // While nothing has moved further than this since they were found, points of a face contact
    // stay where they are on their bodies, and edges that touch are kept without a search.
    double hold;
    // A pair of edges must beat the best face by this: a face gives several
    // points, edges that do not meet almost flat give one.
    double face_preference;
};

struct PairScratch {
    AxisScratch axis, ahead;
    ClipScratch clip;
};

// Inverse masses; 0 for bodies that contacts do not move.
struct Lightness {
    double a, b;
};

// Two bodies at their world poses, what is known of the pair, and where its contact goes.
struct PairCase {
    const AxisKernels &kernels;
    const HullData &a, &b;
    const Rigid &pose_a, &pose_b;
    const PairMotion &motion;
    const PairSettings &settings;
    PairMemory &memory;
    PairScratch &scratch;
    PairContact &out;      // fresh
    Lightness lightness{}; // where one body is no plain polyhedron
};

// What is returned of bodies whose distance apart is not known.
constexpr double NOT_APART = -1e300;

// Finds the contact of two polyhedra. Returns a gap that they have along some axis, if they are
// apart by more than the speculative margin.
double collide_hulls(const PairCase &pair);

// The contact of a pair in which at least one is a sphere, as `collide_hulls` finds that of hulls:
// at most one point, where the two are closest, with the exact gap. Returns the gap of a pair
// without contact, or a lower bound of it.
//
// Bodies that are farther apart than the speculative margin without what they approach in the step
// get the normal with which they will meet, if nothing else stops them, or else pass each other:
// with that of now, a sphere would be stopped by a plane where it will find no sphere.
//
// A pair of spheres has nothing to remember but its point.
double collide_sphere(const PairCase &pair);

// The contact of two polyhedra of which one at least is rounded, as `collide_hulls` finds that of
// hulls: their cores' distance less the radii. Returns the gap of a pair without contact, or a
// lower bound of it.
//
// Where the cores are closest along the normal of a face, the contact is up to four points of that
// face and the one that meets it, with their gaps along its normal, held and named as those of
// hulls; where bodies come fast, corners that land as well. Elsewhere it is the one point where the
// bodies are closest, exact, and where the bodies lie almost flat on each other, points of the face
// beside it. Cores that overlap are parted along the axis on which they are least deep, in one
// point.
//
// Bodies that are farther apart than the speculative margin without what they approach in the step
// get the contact with which they will meet, as spheres do.
double collide_rounded(const PairCase &pair);

} // namespace pluvia
