// How well a sub-step was solved, and the problem itself for others to solve.
#pragma once

#include "contact_colours.h"
#include "contact_solve.h"

#include <vector>

namespace pluvia {

// Sums over contacts, in the kinetic norm: impulses squared by the mass that
// the contact shows, so that both are energies.
struct Residual {
    double error = 0, impulse = 0;
};

// The problem of a sub-step as the solver had it, and what it found, in engine units. What each
// number is says `SubstepRecord` in src/world/bullet/substep.rs.
struct SubstepRecord {
    static constexpr std::size_t BODY = 13; // numbers of each
    std::vector<double> bodies, contacts;
};

// What is read of the last sub-step of a step; the problem, too, where `record` is given.
struct Inspection {
    Residual residual;
    SubstepRecord *record = nullptr;
};

// Adds the natural map of Signorini's and Coulomb's laws,
//   λ − P(λ − m u),
// where u is the speed beyond the bias velocity and P the nearest impulse
// that the laws allow (normal at least 0, friction at most μ times the normal):
// it is 0 where the problem is solved (Acary & Brogliato 2008, "Numerical methods
// for nonsmooth dynamical systems", 12.4; here with the normal law for itself, as
// by Alart & Curnier 1991).
template <class L>
PLUVIA_INLINE void add_residual(const Pack<L> &pack, const Point<L> *points,
                                const Records<L> *motion, Residual &sum) {
    const L zero{};
    const Sides<L> at(pack, motion);
    for (int p = 0; p < pack.points; ++p) {
        const Point<L> &c = points[p];
        const L speed = parting(at, pack.normal, c.angular);
        const L slip_1 = parting(at, pack.tangent_1, c.angular_1);
        const L slip_2 = parting(at, pack.tangent_2, c.angular_2);
        const L error = speed - c.bias + c.softness * c.impulse.x;
        const L wanted = larger(zero, L(c.impulse.x - c.normal_mass * error));
        const L next_1 = c.impulse.y - c.tangent_mass * slip_1;
        const L next_2 = c.impulse.z - c.tangent_mass * slip_2;
        const L scale = within_cone(L(pack.friction * c.impulse.x), next_1, next_2);
        for (int i = 0; i < Lane<L>::WIDTH; ++i) {
            const auto get = [i](const L &lanes) {
                return static_cast<double>(Lane<L>::get(lanes, i));
            };
            const double normal_mass = get(c.normal_mass), tangent_mass = get(c.tangent_mass);
            if (pack.pair[i] < 0 || !(normal_mass > 0) || !(tangent_mass > 0)) {
                continue;
            }
            const auto square = [](double x) { return x * x; };
            const double off = get(c.impulse.x) - get(wanted);
            const double off_1 = get(c.impulse.y) - get(next_1) * get(scale);
            const double off_2 = get(c.impulse.z) - get(next_2) * get(scale);
            sum.error += square(off) / normal_mass + (square(off_1) + square(off_2)) / tangent_mass;
            sum.impulse += square(get(c.impulse.x)) / normal_mass +
                           (square(get(c.impulse.y)) + square(get(c.impulse.z))) / tangent_mass;
        }
    }
}

template <class N>
void record_bodies(const PackedBodies<N> &bodies, bool found, SubstepRecord &out) {
    out.bodies.resize(bodies.motion.size() * SubstepRecord::BODY);
    for (std::size_t b = 0; b < bodies.motion.size(); ++b) {
        const auto &m = bodies.motion[b].at;
        double *to = &out.bodies[b * SubstepRecord::BODY];
        to[0] = static_cast<double>(m[3]);
        to += found ? 7 : 1;
        for (int i = 0; i < 3; ++i) {
            to[i] = static_cast<double>(m[i]);
            to[i + 3] = static_cast<double>(m[i + 4]);
        }
    }
}

// Adds the points that a pack's pairs have, of `places` of all pairs.
template <class L>
void record_contacts(const Pack<L> &pack, const Point<L> *points, const PointMemory<L> *memory,
                     const std::vector<PairPlace> &places, SubstepRecord &out) {
    for (int i = 0; i < Lane<L>::WIDTH; ++i) {
        const int own = pack.pair[i] < 0 ? 0 : places[pack.pair[i]].points;
        for (int p = 0; p < own; ++p) {
            const Point<L> &c = points[p];
            const auto put = [&](const L &lanes) {
                out.contacts.push_back(static_cast<double>(Lane<L>::get(lanes, i)));
            };
            out.contacts.push_back(pack.a[i]);
            out.contacts.push_back(pack.b[i]);
            for (const Three<L> *v :
                 {&pack.normal, &c.angular.a, &c.angular.b, &pack.tangent_1, &c.angular_1.a,
                  &c.angular_1.b, &pack.tangent_2, &c.angular_2.a, &c.angular_2.b}) {
                put(v->x);
                put(v->y);
                put(v->z);
            }
            for (const L *lanes : {&pack.friction, &c.bias, &c.softness, &memory[p].approach,
                                   &pack.restitution, &c.impulse.x, &c.impulse.y, &c.impulse.z}) {
                put(*lanes);
            }
        }
    }
}

} // namespace pluvia
