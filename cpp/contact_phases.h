// What threads do to the pairs and bodies of a sub-step, one kind of work at a time.
#pragma once

#include "contact_impacts.h"
#include "contact_residual.h"

#include <cstdint>
#include <vector>

namespace pluvia {

// Each goes over packs or over bodies; of the others no result depends on the order.
enum class Phase {
    // Packs.
    Prepare,
    WarmStart, // by colour
    TakeAway,  // by colour: from the free motion the impulses that it is to have been without
    BeginSearchOfPoints,
    SolveForcesForward, // these four by colour, those backward from the last to the first
    SolveForcesBackward,
    SolveImpactsForward,
    SolveImpactsBackward,
    AskForForces, // whether packs that bear nothing would bear something
    AskForImpacts,
    AddResidual, // in order, by one thread
    FindFastestImpact,
    BeginCompression,
    BeginRestitution,
    StoreForceImpulses,
    StoreImpactImpulses,
    // Bodies.
    IntegrateVelocities,
    KeepFreeMotion,
    RestoreFreeMotion,
    BeginSearchOfBodies,
    Extrapolate,
    IntegratePositions,
    // Blocks of bodies.
    FindChangeByForces,
    FindChangeByImpacts,
};

// How much the last iteration changed bodies, as energies; by impacts, as squares of a speed.
struct BodyChange {
    double most = 0; // of one body
    double work = 0; // of all together; for impacts as well as an energy
    double all = 0;  // what contacts have changed in the sub-step, of all free ones together
    int touched = 0; // free bodies
    int active = 0;  // those that changed by more than asked for
};

// Sums are made block by block, so that they do not depend on who made which.
constexpr std::size_t BODY_BLOCK = 64;

// Pairs with what iterations keep of them.
template <class L> struct Pairs {
    UnsetVector<Pack<L>> packs;
    UnsetVector<Point<L>> points;
    UnsetVector<Search<L>> search;

    void resize(std::size_t pack_count, std::size_t point_count) {
        packs.resize(pack_count);
        points.resize(point_count);
        search.resize(point_count);
    }
};

// A part of the packs, bodies or blocks of bodies that a phase goes over.
struct Part {
    const int *list;    // of all; null for every one there is
    std::size_t listed; // how many are in the list
    int worker;
    std::size_t begin, end;

    std::size_t at(std::size_t k) const {
        return list == nullptr ? k : static_cast<std::size_t>(list[k]);
    }
};

struct Contacts;
template <class L> struct Problem;
template <class L> using Kernel = void (*)(Phase phase, Problem<L> &problem, const Part &part);

// The pairs and bodies of a step.
template <class L> struct Problem {
    using N = typename Lane<L>::Number;
    const Contacts *contacts = nullptr; // the step's pairs and bodies; valid until the step ends
    Kernel<L> kernel = nullptr;         // runs phases
    Pairs<L> all;
    UnsetVector<PointMemory<L>> memory; // of all points
    std::vector<std::uint8_t> awake;    // by pack: whether iterations visit it
    Pairs<L> few;                       // copies of the pairs of few bodies
    Pairs<L> *pairs;                    // which of them are gone over
    PackedBodies<N> bodies;
    std::vector<std::uint8_t> active;  // by body
    std::vector<BodyChange> changes;   // by block
    std::vector<Unsolved<L>> unsolved; // by worker
    LaneLaw<N> law;
    L beta;            // how far to extrapolate
    double limit;      // from which on a body that changes is active
    Residual residual; // what AddResidual adds to
};

template <Solved WHAT, Half HALF, class L>
PLUVIA_INLINE void visit_all(Problem<L> &p, const Part &part) {
    Unsolved<L> &unsolved = p.unsolved[part.worker];
    Unsolved<L> own = unsolved;
    const L beta = p.beta;
    Records<L> *const motion = p.bodies.motion.data();
    for (std::size_t k = part.begin; k < part.end; ++k) {
        const std::size_t i = part.at(HALF == Half::Forward ? k : part.begin + part.end - 1 - k);
        const Pack<L> &pack = p.pairs->packs[i];
        visit<WHAT, HALF>(pack, &p.pairs->points[pack.first], &p.pairs->search[pack.first], beta,
                          motion, own);
    }
    unsolved = own;
}

template <Solved WHAT, class L> PLUVIA_INLINE void ask_all(Problem<L> &p, const Part &part) {
    L &borne = p.unsolved[part.worker].borne;
    for (std::size_t k = part.begin; k < part.end; ++k) {
        const Pack<L> &pack = p.pairs->packs[part.at(k)];
        borne = larger(
            borne, would_bear<WHAT>(pack, &p.pairs->points[pack.first], p.bodies.motion.data()));
    }
}

template <Solved WHAT, class L> PLUVIA_INLINE void find_change(Problem<L> &p, const Part &part) {
    const auto limit = static_cast<typename Lane<L>::Number>(p.limit);
    for (std::size_t block = part.begin; block < part.end; ++block) {
        const std::size_t end = std::min(part.listed, (block + 1) * BODY_BLOCK);
        BodyChange change;
        for (std::size_t k = block * BODY_BLOCK; k < end; ++k) {
            const std::size_t b = part.at(k);
            const auto &now = p.bodies.motion[b];
            auto one = energy(now, p.bodies.before[b]);
            change.work += static_cast<double>(one);
            if (WHAT == Solved::Impacts) {
                one *= p.bodies.root[b].at[6];
            }
            change.most = std::max(change.most, static_cast<double>(one));
            p.active[b] = one > limit;
            change.active += one > limit;
            // A lid bears a thousand times the weight of a grain: it would say what a grain may
            // change.
            if (WHAT == Solved::Forces && !p.bodies.pressed(b)) {
                const auto all = static_cast<double>(energy(now, p.bodies.free[b]));
                change.all += all;
                change.touched += all > 0;
            }
        }
        p.changes[block] = change;
    }
}

template <class L> PLUVIA_INLINE void run_phase(Phase phase, Problem<L> &p, const Part &part) {
    using N = typename Lane<L>::Number;
    Records<L> *const motion = p.bodies.motion.data();
    struct At {
        const Pack<L> &pack;
        Point<L> *points;
        PointMemory<L> *memory;
        Search<L> *search;
        std::size_t number;
    };
    const auto packs = [&](const auto &what) PLUVIA_INLINED {
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const std::size_t i = part.at(k);
            const Pack<L> &pack = p.pairs->packs[i];
            const auto first = static_cast<std::size_t>(pack.first);
            what(At{pack, &p.pairs->points[first], p.memory.data() + first, &p.pairs->search[first],
                    i});
        }
    };
    const auto bodies = [&](const auto &what) PLUVIA_INLINED {
        for (std::size_t k = part.begin; k < part.end; ++k) {
            what(part.at(k));
        }
    };
    switch (phase) {
    case Phase::Prepare:
        packs([&](const At &at) PLUVIA_INLINED {
            prepare(at.pack, at.points, at.memory, p.law, p.bodies);
            p.awake[at.number] =
                p.contacts->colours.packs()[at.number].near || bears(at.pack, at.points);
        });
        break;
    case Phase::WarmStart:
        packs([&](const At &at) PLUVIA_INLINED { warm_start(at.pack, at.points, motion); });
        break;
    case Phase::TakeAway:
        packs([&](const At &at)
                  PLUVIA_INLINED { warm_start<true>(at.pack, at.points, p.bodies.free.data()); });
        break;
    case Phase::BeginSearchOfPoints:
        packs([&](const At &at) PLUVIA_INLINED {
            for (int n = 0; n < at.pack.points; ++n) {
                at.search[n].impulse = at.points[n].impulse;
            }
        });
        break;
    case Phase::SolveForcesForward:
        visit_all<Solved::Forces, Half::Forward>(p, part);
        break;
    case Phase::SolveForcesBackward:
        visit_all<Solved::Forces, Half::Backward>(p, part);
        break;
    case Phase::SolveImpactsForward:
        visit_all<Solved::Impacts, Half::Forward>(p, part);
        break;
    case Phase::SolveImpactsBackward:
        visit_all<Solved::Impacts, Half::Backward>(p, part);
        break;
    case Phase::AskForForces:
        ask_all<Solved::Forces>(p, part);
        break;
    case Phase::AskForImpacts:
        ask_all<Solved::Impacts>(p, part);
        break;
    case Phase::AddResidual:
        packs([&](const At &at)
                  PLUVIA_INLINED { add_residual(at.pack, at.points, motion, p.residual); });
        break;
    case Phase::FindFastestImpact: {
        L &fastest = p.unsolved[part.worker].fastest;
        packs([&](const At &at) PLUVIA_INLINED {
            find_fastest(at.pack, at.points, at.memory, motion, p.law, fastest);
        });
        break;
    }
    case Phase::BeginCompression:
        packs([&](const At &at) PLUVIA_INLINED {
            begin_compression(at.pack, at.points, at.memory, p.law, p.bodies);
        });
        break;
    case Phase::BeginRestitution:
        packs([&](const At &at)
                  PLUVIA_INLINED { begin_restitution(at.pack, at.points, at.memory, motion); });
        break;
    case Phase::StoreForceImpulses:
        packs([&](const At &at)
                  PLUVIA_INLINED { store_force_impulses(at.pack, at.points, at.memory); });
        break;
    case Phase::StoreImpactImpulses:
        packs([&](const At &at)
                  PLUVIA_INLINED { store_impact_impulses(at.pack, at.points, at.memory); });
        break;
    case Phase::IntegrateVelocities:
        bodies([&](std::size_t b) PLUVIA_INLINED { integrate_velocity(p.bodies, b); });
        break;
    case Phase::KeepFreeMotion:
        bodies([&](std::size_t b) { p.bodies.free[b] = p.bodies.motion[b]; });
        break;
    case Phase::RestoreFreeMotion:
        bodies([&](std::size_t b) { p.bodies.motion[b] = p.bodies.free[b]; });
        break;
    case Phase::BeginSearchOfBodies:
        bodies([&](std::size_t b) PLUVIA_INLINED { begin_search(p.bodies, b); });
        break;
    case Phase::Extrapolate: {
        const N beta = Lane<L>::get(p.beta, 0);
        bodies([&](std::size_t b) PLUVIA_INLINED { extrapolate(p.bodies, b, beta); });
        break;
    }
    case Phase::IntegratePositions:
        bodies([&](std::size_t b) PLUVIA_INLINED { integrate_position(p.bodies, b, p.law.step); });
        break;
    case Phase::FindChangeByForces:
        find_change<Solved::Forces>(p, part);
        break;
    case Phase::FindChangeByImpacts:
        find_change<Solved::Impacts>(p, part);
        break;
    }
}

} // namespace pluvia
