// What the contact solver reads: the law of contacts, and pairs and bodies side by side.
#pragma once

#include "lanes.h"
#include "pool.h"

namespace pluvia {

// Softness and restitution of contacts; engine units.
struct ContactLaw {
    int substeps;         // of a step
    int iterations;       // over all contacts in a sub-step, at least
    double stiffness;     // of a contact point, N/m: mass over time squared, whatever the unit
    double damping_ratio; // of the spring with the bodies it stands between
    double max_depenetration_velocity; // largest speed at which overlap is pushed apart
    double restitution_speed;          // approach speed below which nothing rebounds
    double closed_gap;                 // gap up to which what does not come fast counts as closed
    double unsolved_gap; // overlap that a sub-step may add before it is iterated further
    // What the last iteration may change of any body, as a share of what contacts change of a free
    // one in a sub-step (root mean square).
    double unsolved_share;
};

// Pairs beside each other. The normal leads from B to A. Lanes without a pair hold the
// world with itself, and points that a pair of the pack has less than another are too
// far apart to meet: neither does anything.
template <class L> struct alignas(64) Pack {
    int a[Lane<L>::WIDTH], b[Lane<L>::WIDTH];
    int pair[Lane<L>::WIDTH];      // its number among those that touch; -1 where there is none
    int first, points;             // of its points among all, and how many
    unsigned still_a, still_b;     // a bit for each lane whose body does not move
    unsigned pressed_a, pressed_b; // the same for bodies that are pressed
    Three<L> normal, tangent_1, tangent_2;
    L friction, restitution;
};

// The angular Jacobians of a direction, of either body.
template <class L> struct Jacobian { Three<L> a, b; };

// A point of each pair of a pack: what iterations read and write. Impulses have three components,
// along the normal and the two tangents.
//
// A body turns in these numbers by the root of its inertia times its spin, on
// which an impulse acts by the angular Jacobian alone: the root of the inverse inertia
// times the moment of a unit impulse along normal or tangent.
template <class L> struct alignas(64) Point {
    Jacobian<L> angular, angular_1, angular_2; // of the normal, of the tangents
    L coupling_1, coupling_2; // normal speed that a unit impulse along a tangent gives
    L tangent_mass;
    L bias, normal_mass, softness;
    L most;           // that the normal impulse may become
    Three<L> impulse; // of the sub-step
};

// A moment arm, and what of its point turns with the body. `turns` is 1, or 0 on a sphere, which
// rolls while its contact point stays below it. `ball` is the part of it along the normal of the
// contact that the ball of a rounded polyhedron adds, which likewise stays; 0 for all others.
template <class L> struct Arm : Three<L> { L turns, ball; };

// As for any vector turned by a rotation vector, of what turns with the body.
template <class L>
PLUVIA_INLINE Three<L> turned(const Arm<L> &arm, const Three<L> &by, const Three<L> &normal) {
    const Three<L> &bare = arm;
    const Three<L> ball = normal * arm.ball;
    return turned(Three<L>(bare - ball),
                  Three<L>{by.x * arm.turns, by.y * arm.turns, by.z * arm.turns}) +
           ball;
}

// The rest about it: what a sub-step is set up from.
template <class L> struct alignas(64) PointMemory {
    Arm<L> arm_a, arm_b; // from the centres of mass when the step began
    L gap;               // then
    // Of what the two ends have come apart since, A's share: both bodies are pushed in one point.
    L share;
    L gap_now, approach, mass; // when the sub-step began; `mass` along the normal
    // Of a sub-step with impacts: the approach velocity of an impact (0 for what is none), the
    // normal impulse without restitution, and all that compression has brought it to.
    L impact, solved;
    Three<L> compression;
    Three<L> total; // impulse of the step
};

// Of a point of each pair: what the iteration before the last ended with.
template <class L> struct alignas(64) Search { Three<L> impulse; };

// Bodies in records, each kind by itself: what iterations read and write is the
// motion alone. A kinematic body, or one that stands still, keeps its motion.
//
// A pressed body has one degree of freedom: its speed along a direction times the root of its mass,
// or that about an axis times the root of its moment of inertia. It stands where others have the
// first component of their spin, and all else of its motion is 0 but the last, which is 1. In
// `root` are the velocity of its origin at unit speed and the axis about which it turns (0, 0, 0
// without one), both over that root, the inverse mass, and 1. Of what turns the inverse mass is
// that of a point as far from the axis as it reaches.
template <class N> struct PackedBodies {
    UnsetVector<Record<N>> motion; // velocity, inverse mass, inertia root times spin, 1 if it turns
    // Of the inverse inertia, in the world: xx, yy, zz, xy, xz, yz; the inverse mass, 0.
    UnsetVector<Record<N>> root;
    // Gone since the step began: shift, -, turn (a rotation vector), -.
    UnsetVector<Record<N>> displacement;
    UnsetVector<Record<N>> forced; // what external forces add to the motion in a sub-step
    UnsetVector<Record<N>> free;   // motion without the impulses that are looked for
    UnsetVector<Record<N>> before; // motion that the last iteration began with
    UnsetVector<Record<N>> search; // motion that the iteration before it ended with

    void resize(std::size_t count) {
        for (auto *records : {&motion, &root, &displacement, &forced, &free, &before, &search}) {
            records->resize(count);
        }
    }
    bool pressed(std::size_t body) const { return root[body].at[7] > 0; }
};

} // namespace pluvia
