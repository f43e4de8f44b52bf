// Solves Coulomb's law at one contact point exactly, and projects onto the friction cone.
#include "cone.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace referee {

namespace {

// Relative precision to which sliding is solved.
constexpr double PRECISION = 1e-13;

// Sliding: λ_t = −(S + α)⁻¹ c with an α > 0 at which |λ_t| = μ λ_n, where S and c
// are what the contact plane sees once the normal speed is zero, and α |λ_t| is
// the speed of sliding. Newton's steps from the guess α within a bracket: α = 0
// sticks outside the cone, a large one slides inside.
Vec3 sliding(const Mat3 &w, const Vec3 &q, double friction, double &alpha) {
    const double wnn = w(0, 0), wx = w(0, 1), wy = w(0, 2);
    const double s11 = w(1, 1) - wx * wx / wnn, s22 = w(2, 2) - wy * wy / wnn;
    const double s12 = w(1, 2) - wx * wy / wnn;
    const double cx = q[1] - wx * q[0] / wnn, cy = q[2] - wy * q[0] / wnn;
    double low = 0, high = std::numeric_limits<double>::infinity();
    double n = 0, tx = 0, ty = 0;
    for (int i = 0; i < 200; ++i) {
        const double a = s11 + alpha, b = s22 + alpha, det = 1 / (a * b - s12 * s12);
        tx = (s12 * cy - b * cx) * det;
        ty = (s12 * cx - a * cy) * det;
        n = -(q[0] + wx * tx + wy * ty) / wnn;
        const double size = std::sqrt(tx * tx + ty * ty), most = friction * n;
        if (std::abs(size - most) <= PRECISION * size || high <= low * (1 + PRECISION)) {
            break;
        }
        (size > most ? low : high) = alpha;
        double next = -1;
        if (most > 0) {
            // Newton's step on 1/|λ_t| − 1/(μ λ_n), which is nearly straight in α.
            const double dx = (s12 * ty - b * tx) * det, dy = (s12 * tx - a * ty) * det;
            const double dsize = (tx * dx + ty * dy) / size;
            const double dmost = -friction * (wx * dx + wy * dy) / wnn;
            const double slope = dmost / (most * most) - dsize / (size * size);
            next = alpha - (1 / size - 1 / most) / slope;
        }
        const bool inside = next > low && next < high;
        const double wide = std::isinf(high) ? 4 * low + s11 + s22 : 0.5 * (low + high);
        alpha = inside ? next : wide;
    }
    // On the cone's surface to the last digit.
    const double size = std::sqrt(tx * tx + ty * ty);
    const double scale = size > 0 ? friction * std::max(0.0, n) / size : 0;
    return {std::max(0.0, n), tx * scale, ty * scale};
}

} // namespace

Vec3 solve_contact(const Mat3 &w, const Mat3 &inverse, const Vec3 &q, double friction,
                   double &alpha) {
    if (q[0] >= 0) {
        return Vec3::Zero();
    }
    if (friction <= 0) {
        return {-q[0] / w(0, 0), 0, 0};
    }
    const Vec3 stick = -(inverse * q);
    const double most = friction * stick[0];
    if (most >= 0 && stick[1] * stick[1] + stick[2] * stick[2] <= most * most) {
        return stick;
    }
    return sliding(w, q, friction, alpha);
}

Vec3 solve_loaded_contact(const Mat3 &w, const Vec3 &q, double friction, double normal) {
    const double most = friction * normal;
    if (most <= 0) {
        return {normal, 0, 0};
    }
    // λ_t = −(W_tt + α)⁻¹ c with the least α ≥ 0 at which |λ_t| ≤ most.
    const Vec2 c(q[1] + w(1, 0) * normal, q[2] + w(2, 0) * normal);
    const Eigen::Matrix2d wtt = w.bottomRightCorner<2, 2>();
    const auto at = [&](double alpha) {
        return Vec2(-(wtt + alpha * Eigen::Matrix2d::Identity()).inverse() * c);
    };
    double low = 0, high = c.norm() / most;
    Vec2 t = at(0);
    if (t.norm() > most) {
        for (int i = 0; i < 100 && high - low > 1e-15 * high; ++i) {
            const double middle = 0.5 * (low + high);
            t = at(middle);
            (t.norm() > most ? low : high) = middle;
        }
        t *= most / t.norm();
    }
    return {normal, t.x(), t.y()};
}

Vec3 onto_cone(const Vec3 &x, double friction) {
    const double size = std::sqrt(x[1] * x[1] + x[2] * x[2]);
    if (friction * size <= -x[0]) {
        return Vec3::Zero();
    }
    if (size <= friction * x[0]) {
        return x;
    }
    const double n = (x[0] + friction * size) / (1 + friction * friction);
    const double scale = size > 0 ? friction * n / size : 0;
    return {n, x[1] * scale, x[2] * scale};
}

Vec3 natural_map(const Vec3 &impulse, const Vec3 &speed, double friction, double rho) {
    const double n = std::max(0.0, impulse[0] - rho * speed[0]);
    const double t1 = impulse[1] - rho * speed[1], t2 = impulse[2] - rho * speed[2];
    const double size = std::sqrt(t1 * t1 + t2 * t2), most = friction * n;
    const double scale = size > most ? most / size : 1;
    return {n, t1 * scale, t2 * scale};
}

} // namespace referee
