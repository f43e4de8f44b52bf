// Checks the referee's collision detection on pairs whose contacts are known.
#include "checks.h"
#include "scene.h"

#include <cmath>
#include <limits>
#include <random>

namespace referee {

namespace {

using Random = std::mt19937_64;

double uniform(Random &random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

Quat turned(Random &random) {
    std::normal_distribution<double> normal;
    return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

// A box with its corners pulled about: hexahedra whose faces are cut in two.
Hull pulled_box(Random &random) {
    const Hull box = Hull::box({1, 1.3, 0.8});
    std::vector<Vec3> vertices = box.vertices;
    for (Vec3 &v : vertices) {
        v *= uniform(random, 0.99, 1.01);
    }
    std::vector<std::vector<int>> faces;
    for (const auto &f : box.faces) {
        const auto at = [&](int i) { return vertices[static_cast<std::size_t>(f[i])]; };
        const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
        // The diagonal that keeps it convex.
        if (normal.dot(at(3) - at(0)) <= 0) {
            faces.push_back({f[0], f[1], f[2]});
            faces.push_back({f[0], f[2], f[3]});
        } else {
            faces.push_back({f[0], f[1], f[3]});
            faces.push_back({f[1], f[2], f[3]});
        }
    }
    return {vertices, faces};
}

// Gap along an axis, over all vertices.
double gap_along(const Placed &a, const Placed &b, const Vec3 &axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3 &v : a.vertices) {
        low = std::min(low, axis.dot(v));
    }
    for (const Vec3 &v : b.vertices) {
        high = std::max(high, axis.dot(v));
    }
    return low - high;
}

// The largest gap over every axis that can matter, both ways.
double separation_of_all(const Placed &a, const Placed &b) {
    std::vector<Vec3> axes;
    axes.insert(axes.end(), a.normals.begin(), a.normals.end());
    axes.insert(axes.end(), b.normals.begin(), b.normals.end());
    for (const Vec3 &i : a.directions) {
        for (const Vec3 &j : b.directions) {
            const Vec3 axis = i.cross(j);
            if (axis.norm() > 1e-9) {
                axes.emplace_back(axis.normalized());
            }
        }
    }
    double best = -std::numeric_limits<double>::infinity();
    for (const Vec3 &axis : axes) {
        best = std::max({best, gap_along(a, b, axis), gap_along(a, b, -axis)});
    }
    return best;
}

// Upside down, a roof whose ridge sinks from the one end to the other, where it is lowest; its
// other end is cut off so flatly that no face is nearer to level.
Hull roof() {
    std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0.02}, {1.6, 0.1, 0.132}, {1.6, -0.1, 0.132},
                                  {0, 1, 1}, {0, -1, 1},   {2, -1, 1.04},     {2, 1, 1.04}};
    for (Vec3 &v : vertices) {
        v -= Vec3(0.9, 0, 0.6);
    }
    return {vertices,
            {{0, 4, 7, 2, 1}, {0, 1, 3, 6, 5}, {1, 2, 3}, {2, 7, 6, 3}, {0, 5, 4}, {4, 5, 6, 7}}};
}

} // namespace

void check_contacts(Checks &checks) {
    Random random(1);
    double worst = 0, worst_point = 0;
    int overlapping = 0;
    for (int n = 0; n < 400; ++n) {
        const Hull one = pulled_box(random), other = pulled_box(random);
        Placed a, b;
        a.place(one, Vec3::Zero(), turned(random));
        const Vec3 at(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        b.place(other, at, turned(random));
        const double exact = separation_of_all(a, b);
        if (exact >= 0) {
            continue;
        }
        ++overlapping;
        worst = std::max(worst, std::abs(separation(a, b) - exact));
        std::vector<Touch> found;
        touches(a, b, 0, found);
        double deepest = 0;
        for (const Touch &t : found) {
            deepest = std::min(deepest, t.gap);
        }
        worst_point = std::max(worst_point, deepest - exact);
    }
    checks.above("pairs of random hulls that overlap", overlapping, 100);
    checks.below("depth of random overlaps against all axes", worst, 3e-6);
    checks.below("deepest contact point against the depth", worst_point, 3e-6);

    const Hull cube = Hull::box({0.01, 0.01, 0.01});
    Placed lower, upper;
    lower.place(cube, Vec3::Zero(), Quat::Identity());
    upper.place(cube, {0.002, 0.001, 0.01 + 3e-5}, Quat::Identity());
    std::vector<Touch> found;
    touches(upper, lower, 1e-4, found);
    checks.equal("points of a cube on a cube", static_cast<double>(found.size()), 4, 0);
    Vec3 low = Vec3::Constant(1), high = Vec3::Constant(-1);
    for (const Touch &t : found) {
        checks.equal("gap of a cube above a cube", t.gap, 3e-5, 1e-12);
        checks.equal("its normal leads upwards", t.normal.z(), 1, 1e-12);
        low = low.cwiseMin(t.point);
        high = high.cwiseMax(t.point);
    }
    checks.equal("the points span the overlap along x", high.x() - low.x(), 0.008, 1e-12);
    checks.equal("and along y", high.y() - low.y(), 0.009, 1e-12);
    found.clear();
    touches(upper, lower, 2e-5, found);
    checks.equal("points beyond the margin", static_cast<double>(found.size()), 0, 0);

    // An edge of a cube on an edge of another, parallel: above or beside it.
    upper.place(cube, {0.01 - 1e-6, 0, 0.01 - 2e-6}, Quat::Identity());
    for (const double doubt : {0.0, 1e-5}) {
        found.clear();
        touches(upper, lower, 0, found, doubt);
        Vec3 most = Vec3::Constant(-1);
        for (const Touch &t : found) {
            most = most.cwiseMax(t.normal);
        }
        checks.equal("an axis beside the one of least overlap", most.z(), doubt > 0 ? 1 : 0, 1e-12);
        checks.equal("and that one", most.x(), 1, 1e-12);
    }

    // The lowest corner of a roof, where the face nearest to level has only others.
    const Hull slab = Hull::box({10, 10, 1}), ridge = roof();
    lower.place(slab, {0, 0, -0.5}, Quat::Identity());
    upper.place(ridge, {0, 0, 0.6 - 0.01}, Quat::Identity());
    found.clear();
    touches(upper, lower, 0.05, found);
    checks.equal("points of a roof on its ridge", static_cast<double>(found.size()), 2, 0);
    double deepest = 1;
    for (const Touch &t : found) {
        deepest = std::min(deepest, t.gap);
    }
    checks.equal("the deepest of them", deepest, -0.01, 1e-12);

    // Edges that cross at right angles, 10 µm inside each other.
    const Quat on_edge(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()));
    const Quat across = Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ())) * on_edge;
    lower.place(cube, Vec3::Zero(), on_edge);
    upper.place(cube, {0, 0, 0.01 * std::sqrt(2) - 1e-5}, across);
    found.clear();
    touches(upper, lower, 0, found);
    checks.equal("points of edges that cross", static_cast<double>(found.size()), 1, 0);
    if (!found.empty()) {
        checks.equal("depth of edges that cross", found[0].gap, -1e-5, 1e-12);
        checks.equal("where they cross", found[0].point.z(), 0.005 * std::sqrt(2) - 5e-6, 1e-12);
    }
    found.clear();
    upper.place(cube, {0, 0, 0.005 + 1e-5}, Quat::Identity());
    touches(upper, Plane{Vec3::UnitZ(), 0}, 5e-5, found);
    checks.equal("points of a cube on a plane", static_cast<double>(found.size()), 4, 0);
}

} // namespace referee
