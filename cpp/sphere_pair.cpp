// Finds the contact of a sphere with another body.
#include "hull_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pluvia {

namespace {

// The one point of a contact, whichever body is named first (`swapped_id`).
constexpr std::uint32_t OF_SPHERE = packed(3, INDEX, INDEX);

// Where the surface of a body is closest to a point outside, or, for a point inside, where the
// face of least penetration is. In the body's frame.
struct Closest {
    double distance; // of the point from the surface, negative inside
    Vec normal;      // out of the body, towards a point outside
    Vec on;          // on the surface
};

Closest closest_of_sphere(double radius, const Vec &point) {
    const double far = length(point);
    if (!(far > 0)) {
        return {far - radius, {0, 0, 1}, {0, 0, radius}};
    }
    const Vec normal = point / far;
    return {far - radius, normal, normal * radius};
}

// Looks for the closest point on the sides of a face that the point lies beyond. False where
// there are none: then the face itself is closest.
bool beyond_sides(const HullData &hull, int face, const Vec &point, double &nearest, Vec &on) {
    const int begin = hull.loop_start[face];
    const int end = hull.loop_start[face + 1];
    bool beyond = false;
    for (int k = begin; k < end; ++k) {
        const Vec from = hull.vertex(hull.loop_vertex[k]);
        const Vec side = hull.vertex(hull.loop_vertex[k + 1 < end ? k + 1 : begin]) - from;
        const Vec out = point - from;
        if (out.dot(side.cross(hull.normal(face))) <= 0) {
            continue;
        }
        beyond = true;
        const double square = side.dot(side);
        const double share = square > 0 ? std::clamp(out.dot(side) / square, 0.0, 1.0) : 0;
        const Vec apart = out - side * share;
        if (apart.dot(apart) < nearest) {
            nearest = apart.dot(apart);
            on = point - apart;
        }
    }
    return beyond;
}

Closest closest_of_polyhedron(const HullData &hull, const Vec &point, double enough) {
    int face = 0;
    double widest = -std::numeric_limits<double>::infinity();
    for (int f = 0; f < hull.faces; ++f) {
        const double gap = hull.above(f, point);
        if (gap > widest) {
            widest = gap;
            face = f;
        }
    }
    const auto of_face = [&](int f, double gap) {
        return Closest{gap, hull.normal(f), point - hull.normal(f) * gap};
    };
    if (widest <= 0 || widest > enough) {
        return of_face(face, widest);
    }
    double nearest = std::numeric_limits<double>::infinity();
    Vec on{0, 0, 0};
    for (int f = 0; f < hull.faces; ++f) {
        const double gap = hull.above(f, point);
        if (gap > 0 && !beyond_sides(hull, f, point, nearest, on)) {
            return of_face(f, gap);
        }
    }
    const double distance = std::sqrt(nearest);
    // On an edge there is no direction but that of a face.
    if (distance > 1e-9 * static_cast<double>(hull.radius)) {
        return {distance, (point - on) / distance, on};
    }
    return of_face(face, widest);
}

// Of a body of any shape. Exact, unless `distance` is found to be more than `enough`: then it
// is a lower bound, and `normal` and `on` are those of a face's plane.
Closest closest(const HullData &hull, const Vec &point, double enough) {
    if (hull.is_sphere()) {
        return closest_of_sphere(hull.sphere, point);
    }
    if (!hull.is_rounded()) {
        return closest_of_polyhedron(hull, point, enough);
    }
    Closest out = closest_of_polyhedron(hull, point, enough + hull.rounding);
    out.distance -= hull.rounding;
    out.on = out.on + out.normal * hull.rounding;
    return out;
}

} // namespace

double collide_sphere(const PairCase &pair) {
    // The sphere, and the other body, in whose frame it is seen.
    const bool is_a = pair.a.is_sphere();
    const double radius = is_a ? pair.a.sphere : pair.b.sphere;
    const HullData &other = is_a ? pair.b : pair.a;
    const Rigid &own_pose = is_a ? pair.pose_a : pair.pose_b;
    const Rigid &pose = is_a ? pair.pose_b : pair.pose_a;
    const HullMotion &own = is_a ? pair.motion.a : pair.motion.b;
    const HullMotion &its = is_a ? pair.motion.b : pair.motion.a;
    const double margin = pair.settings.speculative_margin;
    const Vec centre = pose.inverse().apply(own_pose.t);
    // A sphere looks the same however it turns.
    const HullMotion goes{its.velocity, other.is_sphere() ? Vec{0, 0, 0} : its.spin};
    Closest found = closest(other, centre, margin + radius);
    const double gap = found.distance - radius;
    if (gap > margin) {
        return gap;
    }
    // Where the two are closest when they meet within the step, or else when they have come closest
    // in it.
    Rigid then = pose;
    if (gap > margin - pair.settings.approach) {
        Meeting meeting{pair.motion.step};
        Vec at = own_pose.t;
        const auto closing = [&] {
            const Vec speed = own.velocity - its.velocity - goes.spin.cross(at - then.t);
            return -speed.dot(then.turn(found.normal));
        };
        while (meeting.go_on(found.distance - radius, closing())) {
            then = ahead(pose, goes, meeting.time);
            at = own_pose.t + own.velocity * meeting.time;
            found =
                closest(other, then.inverse().apply(at), std::numeric_limits<double>::infinity());
        }
    }
    const Vec normal = then.turn(found.normal);
    // As it is now: what the ball of a rounded polyhedron adds looks where it will.
    const Vec ball = found.normal * other.rounding;
    const Vec on = pose.turn(found.on - ball) + normal * other.rounding;
    const Vec apart = own_pose.t - pose.t - on;
    const double above = apart.dot(normal);
    const Vec across = apart - normal * above;
    // The solver pushes both bodies in one point, nearer to the lighter one, and takes its two
    // ends to lie on the normal now. So they are put where the one point will be right.
    const Lightness &light = pair.lightness;
    const double all = std::max(light.a + light.b, std::numeric_limits<double>::min());
    const double share = (is_a ? light.b : light.a) / all;
    const Vec on_sphere = own_pose.turn_back(normal * -radius - across * share);
    const Vec on_other = pose.turn_back(on + across * (1 - share));
    pair.out.normal = is_a ? -normal : normal;
    pair.out.points[0] = {is_a ? on_sphere : on_other, is_a ? on_other : on_sphere, above - radius,
                          OF_SPHERE};
    pair.out.count = 1;
    return NOT_APART;
}

} // namespace pluvia
