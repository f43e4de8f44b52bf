// Puts pairs and bodies into the solver's packs, and what was found back.
#pragma once

#include "contact_bodies.h"
#include "contact_colours.h"
#include "contact_phases.h"
#include "hull_algorithm.h"
#include "workers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pluvia {

// A step: its pairs and their order, its bodies, and how it is solved.
struct Contacts {
    const ContactLaw &law;
    double substep; // length
    const std::vector<Touching> &touching;
    const std::vector<PairPlace> &places;
    const Colours &colours;
    const Homes &homes;
    Moves moves;
    std::vector<SolverBody> &bodies;
    Workers &workers;
};

// The gap, in engine units, of the points of a pack that a pair has not: their lanes bear nothing
// as long as no body approaches another by as much in a sub-step. That is 100 m for the paper's
// gravel (100 units in a metre), 10 km at the smallest `engine.length_scale` allowed and 1 m at the
// largest. It may not be infinite: it is multiplied by normals, which are 0 in lanes without a
// pair.
constexpr double NEVER = 1e4;

// Two tangents of a unit normal (Duff et al. 2017, "Building an orthonormal basis, revisited").
inline void tangents(const Vec &n, Vec &t1, Vec &t2) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    t1 = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    t2 = {b, sign + n.y * n.y * a, -n.y};
}

// From B to A.
inline Vec normal_of(const Touching &pair) { return three(pair.state->memory.last.normal) * -1.0; }

// From the centres of mass to point `p`, in the world.
struct Arms {
    Vec a, b;

    Arms(const Touching &pair, int p) {
        const KeptPoint &point = pair.state->memory.last.points[p];
        a = pair.a->pose.turn(three(point.on_a));
        b = pair.b->pose.turn(three(point.on_b));
    }
};

// How far the one point in which both bodies are pushed is from A's end towards B's, as a share. A
// corner goes on being where the bodies meet, however far it slides along the other's face; else
// the point is nearer to the lighter body.
inline double share_of_a(const Touching &pair, int p, double inverse_a, double inverse_b) {
    if (pair.a->hull->is_plain() && pair.b->hull->is_plain()) {
        const std::uint32_t id = pair.state->memory.last.points[p].id;
        const bool face_of_b = (id & FROM_FACE_OF_B) != 0;
        switch (point_of(id)) {
        case PointOf::Corner:
            return face_of_b ? 0 : 1;
        case PointOf::CornerOfFace:
            return face_of_b ? 1 : 0;
        case PointOf::Crossing:
        case PointOf::Edges:
            break;
        }
    }
    return inverse_b / std::max(inverse_a + inverse_b, std::numeric_limits<double>::min());
}

template <class L> void set_three(Three<L> &lanes, int i, const Vec &value) {
    using N = typename Lane<L>::Number;
    Lane<L>::set(lanes.x, i, static_cast<N>(value.x));
    Lane<L>::set(lanes.y, i, static_cast<N>(value.y));
    Lane<L>::set(lanes.z, i, static_cast<N>(value.z));
}

// A pack without pairs.
template <class L> void clear_pack(Pack<L> &pack, int first, int points) {
    pack = Pack<L>{};
    pack.first = first;
    pack.points = points;
    pack.still_a = pack.still_b = (1U << Lane<L>::WIDTH) - 1;
    std::fill(pack.pair, pack.pair + Lane<L>::WIDTH, -1);
}

inline unsigned with_bit(unsigned bits, int place, unsigned bit) {
    return (bits & ~(1U << place)) | bit << place;
}

// One lane of numbers that follow each other in memory.
template <class L>
void copy_lanes(const L *from, int from_lane, L *to, int to_lane, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
        Lane<L>::set(to[k], to_lane, Lane<L>::get(from[k], from_lane));
    }
}

template <class L> void copy_lane(const Point<L> &from, int from_lane, Point<L> &to, int to_lane) {
    static_assert(sizeof(Point<L>) % sizeof(L) == 0);
    copy_lanes(reinterpret_cast<const L *>(&from), from_lane, reinterpret_cast<L *>(&to), to_lane,
               sizeof(Point<L>) / sizeof(L));
}

template <class L> void copy_lane(const Pack<L> &from, int from_lane, Pack<L> &to, int to_lane) {
    to.a[to_lane] = from.a[from_lane];
    to.b[to_lane] = from.b[from_lane];
    to.pair[to_lane] = from.pair[from_lane];
    to.still_a = with_bit(to.still_a, to_lane, from.still_a >> from_lane & 1);
    to.still_b = with_bit(to.still_b, to_lane, from.still_b >> from_lane & 1);
    to.pressed_a = with_bit(to.pressed_a, to_lane, from.pressed_a >> from_lane & 1);
    to.pressed_b = with_bit(to.pressed_b, to_lane, from.pressed_b >> from_lane & 1);
    constexpr std::size_t COUNT = 3 * 3 + 2; // from the normal to the restitution
    copy_lanes(&from.normal.x, from_lane, &to.normal.x, to_lane, COUNT);
}

// Puts the pairs of pack number `i` into its lanes. They begin with the normal impulses of the last
// sub-step of the step before, less its impacts, and with the friction of that step in the same
// proportion: what is thrown away has to be found again in a few iterations, and the packing creeps
// numerically while it is not.
template <class L> void load(const Contacts &contacts, std::size_t i, Problem<L> &problem) {
    using N = typename Lane<L>::Number;
    const Moves moves = contacts.moves;
    const Colours::Pack &plan = contacts.colours.packs()[i];
    Pack<L> &pack = problem.all.packs[i];
    clear_pack(pack, plan.first, plan.points);
    const auto first = static_cast<std::size_t>(plan.first);
    for (int p = 0; p < plan.points; ++p) {
        problem.all.points[first + p] = Point<L>{};
        PointMemory<L> &m = problem.memory[first + p];
        m = PointMemory<L>{};
        m.gap = L{} + static_cast<N>(NEVER);
    }
    for (int lane = 0; lane < plan.pairs; ++lane) {
        const int number = contacts.colours.order()[plan.begin + lane];
        const PairPlace &place = contacts.places[number];
        const Touching &pair = contacts.touching[number];
        const KeptContact &contact = pair.state->memory.last;
        const auto put = [lane](L &lanes, double value) {
            Lane<L>::set(lanes, lane, static_cast<N>(value));
        };
        const Vec normal = normal_of(pair);
        Vec tangent_1, tangent_2;
        tangents(normal, tangent_1, tangent_2);
        pack.a[lane] = place.a;
        pack.b[lane] = place.b;
        pack.pair[lane] = number;
        pack.still_a = with_bit(pack.still_a, lane, moves.still(place.a));
        pack.still_b = with_bit(pack.still_b, lane, moves.still(place.b));
        pack.pressed_a = with_bit(pack.pressed_a, lane, moves.pressed(place.a));
        pack.pressed_b = with_bit(pack.pressed_b, lane, moves.pressed(place.b));
        set_three(pack.normal, lane, normal);
        set_three(pack.tangent_1, lane, tangent_1);
        set_three(pack.tangent_2, lane, tangent_2);
        put(pack.friction, static_cast<double>(pair.state->friction));
        put(pack.restitution, static_cast<double>(pair.state->restitution));
        for (int p = 0; p < place.points; ++p) {
            Point<L> &c = problem.all.points[first + p];
            PointMemory<L> &m = problem.memory[first + p];
            const Load &load = pair.state->loads[p];
            const Arms arms(pair, p);
            set_three(m.arm_a, lane, arms.a);
            set_three(m.arm_b, lane, arms.b);
            put(m.arm_a.turns, pair.a->hull->is_sphere() ? 0 : 1);
            put(m.arm_b.turns, pair.b->hull->is_sphere() ? 0 : 1);
            put(m.arm_a.ball, -pair.a->hull->rounding);
            put(m.arm_b.ball, pair.b->hull->rounding);
            put(m.gap, static_cast<double>(contact.points[p].gap));
            put(m.share, share_of_a(pair, p, contacts.bodies[place.a].inverse_mass,
                                    contacts.bodies[place.b].inverse_mass));
            const Vec borne = three(load.impulse);
            const double kept = static_cast<double>(load.warm_start) / contacts.law.substeps;
            set_three(c.impulse, lane,
                      {std::max(0.0, borne.dot(normal)) * kept, borne.dot(tangent_1) * kept,
                       borne.dot(tangent_2) * kept});
        }
    }
}

// Writes what was found in pack number `i` to its pairs.
template <class L> void unload(const Problem<L> &problem, const Contacts &contacts, std::size_t i) {
    const Pack<L> &pack = problem.all.packs[i];
    for (int lane = 0; lane < Lane<L>::WIDTH && pack.pair[lane] >= 0; ++lane) {
        const auto number = static_cast<std::size_t>(pack.pair[lane]);
        const auto get = [lane](const L &lanes) {
            return static_cast<double>(Lane<L>::get(lanes, lane));
        };
        const auto three_of = [&](const Three<L> &v) { return Vec{get(v.x), get(v.y), get(v.z)}; };
        for (int p = 0; p < contacts.places[number].points; ++p) {
            const auto at = static_cast<std::size_t>(pack.first + p);
            const PointMemory<L> &m = problem.memory[at];
            const Vec total = three_of(m.total);
            const Vec borne = three_of(pack.normal) * total.x + three_of(pack.tangent_1) * total.y +
                              three_of(pack.tangent_2) * total.z;
            Load &load = contacts.touching[number].state->loads[p];
            store(borne, load.impulse);
            const double last = get(problem.all.points[at].impulse.x) * contacts.law.substeps;
            load.warm_start = static_cast<float>(total.x > 0 ? last / total.x : 1);
        }
    }
}

template <class N> void pack(const Contacts &contacts, std::size_t i, PackedBodies<N> &packed) {
    const SolverBody &body = contacts.bodies[i];
    const double substep = contacts.substep;
    const auto put = [&](const double(&motion)[8], const double(&root)[8],
                         const double(&forced)[8]) {
        for (int k = 0; k < 8; ++k) {
            packed.motion[i].at[k] = static_cast<N>(motion[k]);
            packed.root[i].at[k] = static_cast<N>(root[k]);
            packed.displacement[i].at[k] = 0;
            packed.forced[i].at[k] = static_cast<N>(forced[k]);
        }
    };
    if (body.pressed()) {
        const Vec &axis = body.press_turn;
        const Vec &free = body.turned() ? axis : body.press;
        const double root = 1 / std::sqrt(free.dot(free)); // of the mass or the moment of inertia
        const Vec along = free * (root * root);            // times that root
        const double arm = body.turned() ? body.reach : 1;
        const double quickness = arm * arm / (root * root);
        const Vec &speed = body.turned() ? body.spin : body.velocity;
        const Vec &faster = body.turned() ? body.spin_up : body.acceleration;
        put({0, 0, 0, 0, along.dot(speed), 0, 0, 1},
            {body.press.x, body.press.y, body.press.z, axis.x, axis.y, axis.z, quickness, 1},
            {0, 0, 0, 0, along.dot(faster) * substep, 0, 0, 0});
        return;
    }
    const bool moves = body.inverse_mass > 0;
    Vec velocity = body.velocity;
    Vec spin = body.spin;
    if (!moves) {
        // A kinematic body's velocity is its mean in the step.
        const double before = substep * (contacts.law.substeps + 1) / 2;
        velocity = velocity - body.acceleration * before;
        spin = spin - body.spin_up * before;
    }
    spin = body.inertia_root * spin;
    const Symmetric<double> &m = body.inverse_inertia_root;
    const Vec v = body.acceleration * substep;
    const Vec w = body.inertia_root * body.spin_up * substep;
    put({velocity.x, velocity.y, velocity.z, body.inverse_mass, spin.x, spin.y, spin.z,
         moves ? 1.0 : 0.0},
        {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, body.inverse_mass, 0},
        {v.x, v.y, v.z, 0, w.x, w.y, w.z, 0});
}

// A step without contacts: the sum over its sub-steps.
inline void fly(SolverBody &body, int substeps, double substep) {
    const double step = substeps * substep;
    const double mean = step * (substep * (substeps + 1) / 2);
    body.shift = body.velocity * step + body.acceleration * mean;
    body.turn = body.spin * step + body.spin_up * mean;
    body.velocity = body.velocity + body.acceleration * step;
    body.spin = body.spin + body.spin_up * step;
}

template <class N> void unpack(const PackedBodies<N> &packed, std::size_t i, SolverBody &body) {
    const auto &m = packed.motion[i].at;
    const auto &w = packed.displacement[i].at;
    if (body.pressed()) {
        body.velocity = body.press * m[4];
        body.spin = body.press_turn * m[4];
    } else {
        body.velocity = {m[0], m[1], m[2]};
        body.spin = body.inverse_inertia_root * Vec{m[4], m[5], m[6]};
    }
    body.shift = {w[0], w[1], w[2]};
    body.turn = {w[4], w[5], w[6]};
}

} // namespace pluvia
