// Convex hulls, with the collision margin that the world was asked for, and spheres.
#pragma once

#include "convert.h"
#include "hull_data.h"
#include "rust/cxx.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>

#include <cstdint>
#include <memory>

namespace pluvia {

struct ShapeDefinition;
struct WorldDefinition;

// Bullet's convex hull, with the axis-aligned box of the hull itself where Bullet's own takes the
// box of the rotated local box: about half as many candidate pairs for round bodies, the same
// contacts. In a native world also a sphere: one point with a margin, and the data of a sphere.
class TightHull final : public btConvexHullShape {
  public:
    void getAabb(const btTransform &pose, btVector3 &low, btVector3 &high) const override;

    // Radius of the sphere about the origin that holds the hull with its margin, in engine units.
    btScalar radius() const { return radius_; }

    // Faces, edges and vertices in engine units, for Pluvia's own hull–hull test.
    const HullData &data() const { return *data_; }

    // To be called once, when all points are there.
    void finish(std::unique_ptr<const HullData> data);

  private:
    btScalar radius_ = 0;
    std::unique_ptr<const HullData> data_;
};

// A shape in engine units for the narrow phase. Throws std::runtime_error where one list leads out
// of another, a coordinate is not finite, a surface is not closed, or the radius cannot be.
std::unique_ptr<const HullData> make_hull_data(const Units &units, const ShapeDefinition &shape);

// A shape for Bullet, too: a hull over the vertices with the collision margin of the world or, of a
// rounded one, with the radius as its margin, for Bullet a part of the shape; a sphere is a
// TightHull in a native world, else Bullet's sphere shape. Throws std::runtime_error, also when
// Bullet does not keep the margin, a vertex or the radius.
std::unique_ptr<btConvexInternalShape> make_shape(const Units &units, const WorldDefinition &world,
                                                  const ShapeDefinition &shape);

// Radius of the sphere about the origin that holds a shape made here, with its margin.
btScalar bounding_radius(const btCollisionShape &shape);

// How many corners a shape has, and the radius in metres of the ball of a rounded polyhedron, 0 of
// all else.
struct Corners {
    std::uint32_t count;
    double rounding;
};

// Appends x, y, z in metres of every corner of a shape made here, of a rounded polyhedron those of
// its core: of the hull data (`of_data`), with which Pluvia's own hull-hull test works, or of
// Bullet's hull, without its margin. A sphere has one, on its surface.
Corners append_corners(const Units &units, const btCollisionShape &shape, bool of_data,
                       rust::Vec<double> &coordinates);

} // namespace pluvia
