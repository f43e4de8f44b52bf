// Leaves out candidate pairs that cannot touch, before Bullet looks closer.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace pluvia {

// Bullet's near callback, preceded by two tests that are exact for what they
// leave out: boxes, then bounding spheres, further apart than the contact
// threshold. A pair that still holds contact points is never left out, since
// Bullet must refresh or drop them. Results stay the same; about half of the
// calls to Bullet's distance algorithm go.
void near_callback(btBroadphasePair &pair, btCollisionDispatcher &dispatcher,
                   const btDispatcherInfo &info);

} // namespace pluvia
