// From the points of a pair to Bullet's manifold, with what the solver wants
// to remember of each point.
#pragma once

#include "hull_pair.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btTransform.h>

namespace pluvia {

// Puts the points of a pair into its manifold, in place of those it held.
//
// A new point takes over the impulses and the age of the old one with the same
// id, or else of the nearest one left over that is closer than `match` (a
// length, in the frame of either body). Where the normal has turned by more
// than eight degrees, the whole impulse, as a vector in the world, is split
// anew into normal and friction; a part that would pull is dropped. A point
// that goes on keeps its place among the points, as far as their number allows.
//
// Of a point: m_normalWorldOnB leads from B to A; m_distance1 is the gap,
// negative for overlap; m_appliedImpulse and the two lateral impulses are
// those of the last step; m_lifeTime is the number of steps the point has
// lived, 0 when it is new; m_index0 is its id, m_index1 the pair's feature.
void write_manifold(const PairContact &contact, const btTransform &pose_a,
                    const btTransform &pose_b, btScalar match, btPersistentManifold &manifold);

// The same for a pair that holds the points of the last step, which are all in
// the manifold: only their places change.
void refresh_manifold(const PairContact &contact, const btTransform &pose_a,
                      const btTransform &pose_b, btPersistentManifold &manifold);

} // namespace pluvia
