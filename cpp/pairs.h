// Leaves out candidate pairs that cannot touch, before Bullet looks closer.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace pluvia {

// Bullet's near callback, preceded by two tests that are exact for what they
// leave out: boxes, then bounding spheres, further apart than the contact
// threshold. A pair that still holds contact points is never left out, since
// Bullet must refresh or drop them. What is left out cannot touch; but pairs
// meet the solver in another order then, so that a chaotic packing comes out
// as another pour does, not bit by bit as without these tests.
void near_callback(btBroadphasePair &pair, btCollisionDispatcher &dispatcher,
                   const btDispatcherInfo &info);

} // namespace pluvia
