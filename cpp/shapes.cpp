// Makes Bullet's shapes of convex polyhedra, rounded polyhedra and spheres, with their exact axis-
// aligned boxes.
#include "shapes.h"

#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

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

Polyhedron polyhedron(rust::Slice<const double> coordinates,
                      rust::Slice<const std::uint32_t> face_starts,
                      rust::Slice<const std::uint32_t> face_vertices) {
    const bool finite = std::all_of(coordinates.begin(), coordinates.end(),
                                    [](double x) { return std::isfinite(x); });
    if (coordinates.empty() || coordinates.size() % 3 != 0 || !finite) {
        throw std::runtime_error("the vertices of a hull are not three finite numbers each");
    }
    const bool whole = face_starts.size() > 1 && face_starts.front() == 0 &&
                       face_starts.back() == face_vertices.size() &&
                       std::adjacent_find(face_starts.begin(), face_starts.end(),
                                          [](std::uint32_t begin, std::uint32_t end) {
                                              return end < begin || end - begin < 3;
                                          }) == face_starts.end();
    if (!whole) {
        throw std::runtime_error("the faces of a hull do not follow one another with three "
                                 "corners each or more");
    }
    return {coordinates.data(), coordinates.size() / 3, face_starts.data(), face_starts.size() - 1,
            face_vertices.data()};
}

std::unique_ptr<const HullData> make_hull_data(const Units &units, Polyhedron p, double rounding) {
    if (!(std::isfinite(rounding) && rounding >= 0)) {
        throw std::runtime_error("the radius of a rounded polyhedron is negative");
    }
    std::vector<double> scaled(p.coordinates, p.coordinates + 3 * p.vertices);
    for (double &x : scaled) {
        x *= units.scale();
    }
    p.coordinates = scaled.data();
    return std::make_unique<const HullData>(p, rounding * units.scale());
}

std::unique_ptr<TightHull> make_hull(const Units &units, const Polyhedron &polyhedron,
                                     double margin, double rounding) {
    auto hull = std::make_unique<TightHull>();
    // Before the box is computed: Bullet's cached box keeps the margin that
    // the shape had at that moment (btPolyhedralConvexShape.cpp, 3.24).
    hull->setMargin(units.length(margin));
    for (std::size_t i = 0; i < polyhedron.vertices; ++i) {
        const double *p = polyhedron.coordinates + 3 * i;
        hull->addPoint(units.length({p[0], p[1], p[2]}), false);
    }
    if (hull->getMargin() != units.length(margin)) {
        throw std::runtime_error("Bullet did not keep the collision margin of a hull");
    }
    if (static_cast<std::size_t>(hull->getNumPoints()) != polyhedron.vertices) {
        throw std::runtime_error("Bullet did not keep every vertex of a hull");
    }
    hull->finish(make_hull_data(units, polyhedron, rounding));
    return hull;
}

std::unique_ptr<btConvexInternalShape> make_sphere(const Units &units, double radius, bool native) {
    if (!(std::isfinite(radius) && radius > 0)) {
        throw std::runtime_error("the radius of a sphere is not positive");
    }
    if (!native) {
        auto sphere = std::make_unique<btSphereShape>(units.length(radius));
        if (sphere->getRadius() != units.length(radius)) {
            throw std::runtime_error("Bullet did not keep the radius of a sphere");
        }
        return sphere;
    }
    auto sphere = std::make_unique<TightHull>();
    sphere->setMargin(units.length(radius));
    sphere->addPoint(btVector3(0, 0, 0), false);
    sphere->finish(std::make_unique<const HullData>(radius * units.scale()));
    return sphere;
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
