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

// Bullet's convex hull, with the axis-aligned box of the hull itself where
// Bullet's own takes the box of the rotated local box: about half as many
// candidate pairs for round bodies, the same contacts. In a native world also a sphere: one point
// with a margin, and the data of a sphere.
class TightHull final : public btConvexHullShape {
  public:
    void getAabb(const btTransform &pose, btVector3 &low, btVector3 &high) const override;

    // Radius of the sphere about the origin that holds the hull with its margin, in
    // engine units.
    btScalar radius() const { return radius_; }

    // Faces, edges and vertices in engine units, for Pluvia's own hull–hull test.
    const HullData &data() const { return *data_; }

    // To be called once, when all points are there.
    void finish(std::unique_ptr<const HullData> data);

  private:
    btScalar radius_ = 0;
    std::unique_ptr<const HullData> data_;
};

// A polyhedron as it crosses the bridge, in metres, from three lists. Throws std::runtime_error
// where one leads out of another, or a coordinate is not finite.
Polyhedron polyhedron(rust::Slice<const double> coordinates,
                      rust::Slice<const std::uint32_t> face_starts,
                      rust::Slice<const std::uint32_t> face_vertices);

// The polyhedron in engine units for the narrow phase, swept by a ball of a radius in metres.
// Throws std::runtime_error when its surface is not closed or the radius negative.
std::unique_ptr<const HullData> make_hull_data(const Units &units, Polyhedron polyhedron,
                                               double rounding);

// A hull over the polyhedron's vertices, with a collision margin in metres; swept by a ball with a
// radius in metres, which is then the margin as well, for Bullet a part of the shape. Throws
// std::runtime_error when Bullet does not keep the margin or a vertex.
std::unique_ptr<TightHull> make_hull(const Units &units, const Polyhedron &polyhedron,
                                     double margin, double rounding = 0);

// A sphere with a radius in metres: `native`, a TightHull; else Bullet's sphere shape. Throws
// std::runtime_error when the radius is not positive.
std::unique_ptr<btConvexInternalShape> make_sphere(const Units &units, double radius, bool native);

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
