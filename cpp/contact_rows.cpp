#include "contact_rows.h"

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

template <class N> Three<double> three(const N x[3]) {
    return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
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

ContactRow make_row(const ContactLaw &law, double step, const Touching &pair, int point, int a,
                    int b, const SolverBody &body_a, const SolverBody &body_b) {
    const KeptContact &contact = pair.state->memory.last;
    ContactRow row;
    row.a = a;
    row.b = b;
    row.load = &pair.state->loads[point];
    row.normal = three(contact.normal) * -1.0;
    tangents(row.normal, row.tangent_1, row.tangent_2);
    double arm[3];
    pair.a->pose.turn(contact.points[point].on_a, arm);
    row.arm_a = three(arm);
    pair.b->pose.turn(contact.points[point].on_b, arm);
    row.arm_b = three(arm);
    row.friction = static_cast<double>(pair.state->friction);
    row.restitution = static_cast<double>(pair.state->restitution);
    row.kept = static_cast<double>(row.load->kept);
    row.gap = static_cast<double>(contact.points[point].gap);

    // The last step's impulses, whole: what is thrown away has to be found
    // again in a few iterations, and the packing creeps while it is not.
    const Three<double> borne = three(row.load->impulse);
    row.impulse = std::max(0.0, borne.dot(row.normal));
    row.impulse_1 = borne.dot(row.tangent_1);
    row.impulse_2 = borne.dot(row.tangent_2);

    const double parting =
        (speed_at(body_a, row.arm_a) - speed_at(body_b, row.arm_b)).dot(row.normal);
    row.near = row.impulse > 0 || row.gap + std::min(0.0, parting * step) <= law.closed_gap;
    return row;
}

void write_row(const ContactRow &row) {
    const Three<double> borne =
        row.normal * row.impulse + row.tangent_1 * row.impulse_1 + row.tangent_2 * row.impulse_2;
    row.load->impulse[0] = static_cast<float>(borne.x);
    row.load->impulse[1] = static_cast<float>(borne.y);
    row.load->impulse[2] = static_cast<float>(borne.z);
    row.load->kept = static_cast<float>(row.kept);
}

} // namespace pluvia
