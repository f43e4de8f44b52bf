// Convex hulls with zero collision margin.
#pragma once

#include "convert.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <cstddef>
#include <memory>

namespace pluvia {

// Bullet's convex hull, with the axis-aligned box of the hull itself where
// Bullet's own takes the box of the rotated local box: about half as many
// candidate pairs for round bodies, the same contacts.
class TightHull final : public btConvexHullShape {
  public:
    void getAabb(const btTransform &pose, btVector3 &low, btVector3 &high) const override;

    // Radius of the sphere about the origin that holds the hull, in engine units.
    btScalar radius() const { return radius_; }
    void set_radius();

  private:
    btScalar radius_ = 0;
};

// A hull over `count` vertices (x, y, z in metres, one after the other).
// Throws std::runtime_error when Bullet does not keep the zero margin.
std::unique_ptr<TightHull> make_hull(const Units &units, const double *coordinates,
                                     std::size_t count);

} // namespace pluvia
