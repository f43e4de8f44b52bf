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

// Speed of the body at an arm.
Three<double> speed_at(const SolverBody &body, const Three<double> &arm) {
    return body.velocity + body.spin.cross(arm);
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

    row.restitution = static_cast<double>(point.m_combinedRestitution);
    row.arrival = static_cast<double>(point.m_contactMotion1);
    row.gap = static_cast<double>(point.m_distance1);

    // The last step's impulses, whole: what is thrown away has to be found
    // again in a few iterations, and the packing creeps while it is not.
    row.impulse = std::max(0.0, static_cast<double>(point.m_appliedImpulse));
    const Three<double> rubbed =
        three(point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
              point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2);
    row.impulse_1 = rubbed.dot(row.tangent_1);
    row.impulse_2 = rubbed.dot(row.tangent_2);

    const double parting =
        (speed_at(body_a, row.arm_a) - speed_at(body_b, row.arm_b)).dot(row.normal);
    row.near = row.impulse > 0 || row.gap + std::min(0.0, parting * step) <= law.closed_gap;
    return row;
}

void write_row(const ContactRow &row) {
    btManifoldPoint &point = *row.point;
    const Three<double> rubbed = row.tangent_1 * row.impulse_1 + row.tangent_2 * row.impulse_2;
    const double size = std::sqrt(rubbed.dot(rubbed));
    point.m_contactMotion1 = static_cast<btScalar>(row.arrival);
    point.m_appliedImpulse = static_cast<btScalar>(row.impulse);
    point.m_appliedImpulseLateral1 = static_cast<btScalar>(size);
    point.m_appliedImpulseLateral2 = 0;
    point.m_lateralFrictionDir1 = vector(size > 0 ? rubbed * (1 / size) : row.tangent_1);
    point.m_lateralFrictionDir2 = vector(row.tangent_2);
}

} // namespace pluvia
