#include "contact_rows.h"

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

Three<double> three(const btVector3 &v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

btVector3 vector(const Three<double> &v) {
    return btVector3(static_cast<btScalar>(v.x), static_cast<btScalar>(v.y),
                     static_cast<btScalar>(v.z));
}

// Two tangents of a unit normal (Duff et al. 2017, "Building an orthonormal
// basis, revisited").
void tangents(const Three<double> &n, Three<double> &t1, Three<double> &t2) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    t1 = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    t2 = {b, sign + n.y * n.y * a, -n.y};
}

// Relative speed of two directions at the contact per unit of impulse.
double compliance(const SolverBody &body, const Three<double> &arm, const Three<double> &d,
                  const Three<double> &e) {
    return body.inverse_mass * d.dot(e) + arm.cross(d).dot(body.inverse_inertia * arm.cross(e));
}

// Speed at the contact of a body that moves as it is told; 0 of every other.
Three<double> driven_speed(const SolverBody &body, const Three<double> &arm) {
    if (body.inverse_mass > 0) {
        return {0, 0, 0};
    }
    return body.velocity + body.spin.cross(arm);
}

// The speed to reach along the normal, and how the row yields.
//
// A contact that is not closed yet is met exactly at the end of the step. One
// that closes and came with a speed worth mentioning leaves with the coefficient
// of restitution times that speed, which was remembered from the step in
// which it was still free. Everything else is an implicit spring and damper
// (Catto 2011, "Soft constraints"): stiffness k, damping c = 2 ζ √(k m),
// yield γ = 1/(h (c + h k)), share of the overlap to remove in a step
// β = h k/(c + h k).
void set_target(const ContactLaw &law, double step, double mass, btManifoldPoint &point, double gap,
                double approach, ContactRow &row) {
    double arrival = std::max(approach, static_cast<double>(point.m_contactMotion1));
    row.yield = 0;
    if (gap > law.closed_gap) {
        row.target = -gap / step;
    } else if (arrival > law.restitution_speed && point.m_combinedRestitution > 0) {
        row.target = static_cast<double>(point.m_combinedRestitution) * arrival;
        arrival = 0;
    } else {
        const double damping = 2 * law.damping_ratio * std::sqrt(law.stiffness * mass);
        const double sum = damping + step * law.stiffness;
        const double share = step * law.stiffness / sum;
        row.yield = 1 / (step * sum);
        row.target = std::min(-share * gap / step, law.push_out_speed);
        arrival = 0;
    }
    row.normal_mass = 1 / (1 / mass + row.yield);
    point.m_contactMotion1 = static_cast<btScalar>(arrival);
}

} // namespace

ContactRow make_row(const ContactLaw &law, double step, int a, int b, const SolverBody &body_a,
                    const SolverBody &body_b, const btVector3 &centre_a, const btVector3 &centre_b,
                    btManifoldPoint &point) {
    ContactRow row;
    row.a = a;
    row.b = b;
    row.point = &point;
    row.normal = three(point.m_normalWorldOnB);
    tangents(row.normal, row.tangent_1, row.tangent_2);
    row.arm_a = three(point.m_positionWorldOnA - centre_a);
    row.arm_b = three(point.m_positionWorldOnB - centre_b);
    row.friction = static_cast<double>(point.m_combinedFriction);

    const auto between = [&](const Three<double> &d, const Three<double> &e) {
        return compliance(body_a, row.arm_a, d, e) + compliance(body_b, row.arm_b, d, e);
    };
    const double mass = 1 / between(row.normal, row.normal);
    const Three<double> speed = body_a.velocity + body_a.spin.cross(row.arm_a) - body_b.velocity -
                                body_b.spin.cross(row.arm_b);
    // Driven bodies are where they will be at the end of the step, all others
    // where they were at its beginning: the gap is that of the beginning.
    double gap = static_cast<double>(point.m_distance1);
    gap -= step * driven_speed(body_a, row.arm_a).dot(row.normal);
    gap += step * driven_speed(body_b, row.arm_b).dot(row.normal);
    set_target(law, step, mass, point, gap, -speed.dot(row.normal), row);

    const double k11 = between(row.tangent_1, row.tangent_1);
    const double k22 = between(row.tangent_2, row.tangent_2);
    const double k12 = between(row.tangent_1, row.tangent_2);
    // One mass for all directions of the plane, the smallest: friction of a
    // sliding contact then points against its speed. With the inverse of the
    // 2 x 2 matrix it would point elsewhere at every corner of a body, and the
    // parts that cancel out would use up the cone (a block that slides along
    // its edges was found to lose 8 % of its friction).
    const double half_trace = (k11 + k22) / 2;
    const double determinant = k11 * k22 - k12 * k12;
    row.tangent_mass =
        1 / (half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - determinant)));

    // The last step's impulses, whole: what is thrown away has to be found
    // again in a few iterations, and the packing creeps while it is not.
    row.impulse = std::max(0.0, static_cast<double>(point.m_appliedImpulse));
    const Three<double> rubbed =
        three(point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
              point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2);
    row.impulse_1 = rubbed.dot(row.tangent_1);
    row.impulse_2 = rubbed.dot(row.tangent_2);
    return row;
}

void write_row(const ContactRow &row) {
    btManifoldPoint &point = *row.point;
    const Three<double> rubbed = row.tangent_1 * row.impulse_1 + row.tangent_2 * row.impulse_2;
    const double size = std::sqrt(rubbed.dot(rubbed));
    point.m_appliedImpulse = static_cast<btScalar>(row.impulse);
    point.m_appliedImpulseLateral1 = static_cast<btScalar>(size);
    point.m_appliedImpulseLateral2 = 0;
    point.m_lateralFrictionDir1 = vector(size > 0 ? rubbed * (1 / size) : row.tangent_1);
    point.m_lateralFrictionDir2 = vector(row.tangent_2);
}

} // namespace pluvia
