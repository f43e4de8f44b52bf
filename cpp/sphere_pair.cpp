#include "sphere_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pluvia {

namespace {

// The one point of a contact, whichever body is named first (`swapped_id`).
constexpr std::uint32_t OF_SPHERE = FROM_EDGES | ((1U << 28) - 1);

// Steps in which the moment of meeting is found: quadratically, as distances from convex bodies
// are convex in time.
constexpr int MOST_STEPS = 16;

// a + s b.
void add(const double a[3], double s, const double b[3], double out[3]) {
    for (int i = 0; i < 3; ++i) {
        out[i] = a[i] + s * b[i];
    }
}

void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

void vertex(const HullData &hull, int v, double out[3]) {
    out[0] = hull.vx[v];
    out[1] = hull.vy[v];
    out[2] = hull.vz[v];
}

Closest closest_of_sphere(double radius, const double point[3]) {
    const double far = std::sqrt(dot(point, point));
    Closest out{far - radius, {0, 0, 1}, {0, 0, radius}};
    for (int i = 0; far > 0 && i < 3; ++i) {
        out.normal[i] = point[i] / far;
        out.on[i] = radius * out.normal[i];
    }
    return out;
}

// Looks for the closest point on the sides of a face that the point lies beyond. False where
// there are none: then the face itself is closest.
bool beyond_sides(const HullData &hull, int face, const double point[3], double &nearest,
                  double on[3]) {
    const double n[3] = {hull.nx[face], hull.ny[face], hull.nz[face]};
    const int begin = hull.loop_start[face];
    const int end = hull.loop_start[face + 1];
    bool beyond = false;
    for (int k = begin; k < end; ++k) {
        double from[3], to[3], side[3], out[3], outward[3];
        vertex(hull, hull.loop_vertex[k], from);
        vertex(hull, hull.loop_vertex[k + 1 < end ? k + 1 : begin], to);
        add(to, -1, from, side);
        add(point, -1, from, out);
        cross(side, n, outward);
        if (dot(out, outward) <= 0) {
            continue;
        }
        beyond = true;
        const double length = dot(side, side);
        const double share = length > 0 ? std::clamp(dot(out, side) / length, 0.0, 1.0) : 0;
        double apart[3];
        add(out, -share, side, apart);
        const double square = dot(apart, apart);
        if (square < nearest) {
            nearest = square;
            add(point, -1, apart, on);
        }
    }
    return beyond;
}

Closest closest_of_polyhedron(const HullData &hull, const double point[3], double enough) {
    int face = 0;
    double widest = -std::numeric_limits<double>::infinity();
    for (int f = 0; f < hull.faces; ++f) {
        const double n[3] = {hull.nx[f], hull.ny[f], hull.nz[f]};
        const double gap = dot(n, point) - static_cast<double>(hull.offset[f]);
        if (gap > widest) {
            widest = gap;
            face = f;
        }
    }
    Closest out{widest, {hull.nx[face], hull.ny[face], hull.nz[face]}, {0, 0, 0}};
    add(point, -widest, out.normal, out.on);
    if (widest <= 0 || widest > enough) {
        return out;
    }
    double nearest = std::numeric_limits<double>::infinity();
    double on[3] = {0, 0, 0};
    for (int f = 0; f < hull.faces; ++f) {
        const double n[3] = {hull.nx[f], hull.ny[f], hull.nz[f]};
        const double gap = dot(n, point) - static_cast<double>(hull.offset[f]);
        if (gap > 0 && !beyond_sides(hull, f, point, nearest, on)) {
            out.distance = gap;
            std::copy(n, n + 3, out.normal);
            add(point, -gap, n, out.on);
            return out;
        }
    }
    const double distance = std::sqrt(nearest);
    // On an edge there is no direction but that of a face.
    if (distance > 1e-9 * static_cast<double>(hull.radius)) {
        out.distance = distance;
        for (int i = 0; i < 3; ++i) {
            out.normal[i] = (point[i] - on[i]) / distance;
            out.on[i] = on[i];
        }
    }
    return out;
}

// How a sphere comes to another body, in the frame of the other.
class Approach {
  public:
    Approach(const HullData &hull, double radius, const double centre[3], const double velocity[3],
             double enough)
        : hull_(hull), radius_(radius), centre_(centre), velocity_(velocity), enough_(enough) {}

    // Where the two are closest when they meet within the step, or else when they have come
    // closest in it. A tangent of a convex function lies below it: Newton's steps never pass the
    // moment of meeting.
    Closest meet(const Closest &now, double step) const {
        Closest out = now;
        double time = 0, early = 0, late = step;
        for (int i = 0; i < MOST_STEPS; ++i) {
            const double gap = out.distance - radius_;
            const double closing = -dot(velocity_, out.normal);
            if (gap <= 0) {
                break;
            }
            double next;
            if (closing > 0) {
                early = time;
                next = time + gap / closing;
                if (next >= late) {
                    next = late < step ? (early + late) / 2 : step;
                }
            } else {
                late = time;
                next = (early + late) / 2;
            }
            if (std::abs(next - time) <= 1e-6 * step) {
                break;
            }
            time = next;
            double at[3];
            add(centre_, time, velocity_, at);
            out = closest(hull_, at, std::numeric_limits<double>::infinity());
        }
        return out;
    }

    Closest now() const { return closest(hull_, centre_, enough_ + radius_); }

  private:
    const HullData &hull_;
    double radius_;
    const double *centre_;
    const double *velocity_;
    double enough_;
};

} // namespace

Closest closest(const HullData &hull, const double point[3], double enough) {
    if (hull.is_sphere()) {
        return closest_of_sphere(hull.sphere, point);
    }
    if (!hull.is_rounded()) {
        return closest_of_polyhedron(hull, point, enough);
    }
    Closest out = closest_of_polyhedron(hull, point, enough + hull.rounding);
    out.distance -= hull.rounding;
    for (int i = 0; i < 3; ++i) {
        out.on[i] += hull.rounding * out.normal[i];
    }
    return out;
}

double collide_sphere(const HullData &a, const HullData &b, const Rigid &pose_a,
                      const Rigid &pose_b, const PairMotion &motion, const Lightness &lightness,
                      const PairSettings &settings, PairContact &out) {
    out.count = 0;
    out.feature = 0;
    out.held = false;
    // The sphere, and the other body, in whose frame it is seen.
    const bool is_a = a.is_sphere();
    const double radius = is_a ? a.sphere : b.sphere;
    const HullData &other = is_a ? b : a;
    const Rigid &pose = is_a ? pose_b : pose_a;
    const double *place = is_a ? pose_a.t : pose_b.t;
    const HullMotion &own = is_a ? motion.a : motion.b;
    const HullMotion &its = is_a ? motion.b : motion.a;
    const Rigid into = pose.inverse();
    double centre[3], velocity[3], relative[3], arm[3], turning[3];
    into.apply(place, centre);
    add(place, -1, pose.t, arm);
    cross(its.spin, arm, turning);
    add(own.velocity, -1, its.velocity, relative);
    add(relative, -1, turning, relative);
    into.turn(relative, velocity);

    const Approach approach(other, radius, centre, velocity, settings.speculative_margin);
    Closest found = approach.now();
    const double gap = found.distance - radius;
    if (gap > settings.speculative_margin) {
        return gap;
    }
    if (gap > settings.speculative_margin - settings.approach) {
        found = approach.meet(found, motion.step);
    }
    // Of the centre now, along the normal and across it: 0, but for what comes from afar.
    double apart[3], across[3];
    add(centre, -1, found.on, apart);
    const double above = dot(apart, found.normal);
    add(apart, -above, found.normal, across);
    // The solver pushes both bodies in one point, nearer to the lighter one, and takes its two
    // ends to lie on the normal now. So they are put where the one point will be right.
    const double all = std::max(lightness.a + lightness.b, std::numeric_limits<double>::min());
    const double share = (is_a ? lightness.b : lightness.a) / all;
    double reach[3], normal[3], on_sphere[3], on_other[3];
    for (int i = 0; i < 3; ++i) {
        reach[i] = -radius * found.normal[i] - share * across[i];
        on_other[i] = found.on[i] + (1 - share) * across[i];
    }
    pose.turn(reach, normal);
    (is_a ? pose_a : pose_b).inverse().turn(normal, on_sphere);
    pose.turn(found.normal, normal);
    PairPoint &point = out.points[0];
    std::copy(on_sphere, on_sphere + 3, is_a ? point.on_a : point.on_b);
    std::copy(on_other, on_other + 3, is_a ? point.on_b : point.on_a);
    for (int i = 0; i < 3; ++i) {
        out.normal[i] = is_a ? -normal[i] : normal[i];
    }
    point.gap = above - radius;
    point.id = OF_SPHERE;
    out.count = 1;
    return point.gap;
}

} // namespace pluvia
