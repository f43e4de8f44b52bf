// Bullet's dispatcher with Pluvia's hull–hull test in it, or without.
#pragma once

#include "hull_algorithm.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <memory>

namespace pluvia {

class HullDispatcher final : public btCollisionDispatcher {
  public:
    // With `collision`, which must outlive the dispatcher, pairs of hulls are
    // Pluvia's; with null they are Bullet's. Every shape must be a TightHull.
    HullDispatcher(btCollisionConfiguration *configuration, HullCollision *collision);

    const HullCollision *collision() const { return collision_; }

  private:
    HullCollision *collision_;
    std::unique_ptr<HullCreateFunc> create_;
};

} // namespace pluvia
