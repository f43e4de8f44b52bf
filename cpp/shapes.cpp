// Makes Bullet's shapes of convex polyhedra, rounded polyhedra and spheres, with their exact axis-
// aligned boxes.
#include "shapes.h"

#include "pluvia/src/world/bullet/ffi.rs.h"

#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace pluvia {

void TightHull::getAabb(const btTransform &pose, btVector3 &low, btVector3 &high) const {
    const int count = getNumPoints();
    const btVector3 *points = getUnscaledPoints();
    low = high = pose(points[0]);
    for (int i = 1; i < count; ++i) {
        const btVector3 p = pose(points[i]);
        low.setMin(p);
        high.setMax(p);
    }
    const btScalar margin = getMargin();
    low -= btVector3(margin, margin, margin);
    high += btVector3(margin, margin, margin);
}

void TightHull::finish(std::unique_ptr<const HullData> data) {
    recalcLocalAabb();
    for (int i = 0; i < getNumPoints(); ++i) {
        radius_ = btMax(radius_, getUnscaledPoints()[i].length());
    }
    radius_ += getMargin();
    data_ = std::move(data);
}

std::unique_ptr<const HullData> make_hull_data(const Units &units, const ShapeDefinition &shape) {
    const auto &starts = shape.face_starts;
    if (shape.coordinates.empty() && starts.empty() && shape.face_vertices.empty()) {
        if (!(std::isfinite(shape.radius) && shape.radius > 0)) {
            throw std::runtime_error("the radius of a sphere is not positive");
        }
        return std::make_unique<const HullData>(shape.radius * units.scale());
    }
    if (!(std::isfinite(shape.radius) && shape.radius >= 0)) {
        throw std::runtime_error("the radius of a rounded polyhedron is negative or not finite");
    }
    const auto &coordinates = shape.coordinates;
    if (coordinates.empty() || coordinates.size() % 3 != 0 ||
        !std::all_of(coordinates.begin(), coordinates.end(),
                     [](double x) { return std::isfinite(x); })) {
        throw std::runtime_error("the vertices of a hull are not three finite numbers each");
    }
    const bool whole = starts.size() > 1 && starts.front() == 0 &&
                       starts.back() == shape.face_vertices.size() &&
                       std::adjacent_find(starts.begin(), starts.end(),
                                          [](std::uint32_t begin, std::uint32_t end) {
                                              return end < begin || end - begin < 3;
                                          }) == starts.end();
    if (!whole) {
        throw std::runtime_error("the faces of a hull do not follow one another with three "
                                 "corners each or more");
    }
    return std::make_unique<const HullData>(shape, units.scale());
}

std::unique_ptr<btConvexInternalShape> make_shape(const Units &units, const WorldDefinition &world,
                                                  const ShapeDefinition &shape) {
    auto data = make_hull_data(units, shape);
    const btScalar radius = units.length(shape.radius);
    if (data->is_sphere() && !world.own_collision) {
        auto sphere = std::make_unique<btSphereShape>(radius);
        if (sphere->getRadius() != radius) {
            throw std::runtime_error("Bullet did not keep the radius of a sphere");
        }
        return sphere;
    }
    auto hull = std::make_unique<TightHull>();
    // Before the box is computed: Bullet's cached box keeps the margin that the shape had at that
    // moment (btPolyhedralConvexShape.cpp, 3.24).
    const btScalar margin = data->is_plain() ? units.length(world.collision_margin) : radius;
    hull->setMargin(margin);
    if (data->is_sphere()) {
        hull->addPoint(btVector3(0, 0, 0), false);
    }
    for (std::size_t i = 0; i < shape.coordinates.size(); i += 3) {
        const double *p = &shape.coordinates[i];
        hull->addPoint(units.length({p[0], p[1], p[2]}), false);
    }
    if (hull->getMargin() != margin) {
        throw std::runtime_error("Bullet did not keep the collision margin of a hull");
    }
    if (hull->getNumPoints() != data->vertices) {
        throw std::runtime_error("Bullet did not keep every vertex of a hull");
    }
    hull->finish(std::move(data));
    return hull;
}

btScalar bounding_radius(const btCollisionShape &shape) {
    return shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE
               ? static_cast<const btSphereShape &>(shape).getRadius()
               : static_cast<const TightHull &>(shape).radius();
}

Corners append_corners(const Units &units, const btCollisionShape &shape, bool of_data,
                       rust::Vec<double> &coordinates) {
    const auto put = [&](const std::array<double, 3> &corner) {
        std::copy(corner.begin(), corner.end(), std::back_inserter(coordinates));
    };
    if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
        put({units.metres(bounding_radius(shape)), 0, 0});
        return {1, 0};
    }
    const auto &hull = static_cast<const TightHull &>(shape);
    const HullData &data = hull.data();
    if (data.is_sphere()) {
        put({units.metres(data.sphere), 0, 0});
        return {1, 0};
    }
    const int count = of_data ? data.vertices : hull.getNumPoints();
    for (int i = 0; i < count; ++i) {
        put(of_data ? units.metres(data.vertex(i)) : units.metres(hull.getUnscaledPoints()[i]));
    }
    const double margin = data.is_rounded() ? static_cast<double>(hull.getMargin()) : 0;
    return {static_cast<std::uint32_t>(count), units.metres(of_data ? data.rounding : margin)};
}

} // namespace pluvia
