// The control of the sub-steps of a step: what is done when, by all threads.
#pragma once

#include "contact_few.h"

#include <cmath>

namespace pluvia {

// Most iterations in a sub-step, unless more are asked for; those of a part of
// the pairs count by that part, choosing the part as one.
constexpr int MOST_ITERATIONS = 256;

// Among few pairs there are more iterations than asked for, until the first number of packs has
// been solved or the second number of iterations is reached: they cost nothing, without them a
// single block is half a percent of its path off after it has slid, and one that meets two supports
// needs hundreds for the impact.
constexpr int SMALL_WORK = 512;
constexpr int SMALL_ITERATIONS = 32;
constexpr int SMALL_IMPACT_ITERATIONS = 256;

// Once fewer than one in the first number of bodies change too much, iterations
// go over the pairs of those alone, at most the second number of times.
constexpr int FEW = 64;
constexpr int LOCAL_ITERATIONS = 16;

// How often those beside them that were moved by it become the few, before all are looked at.
constexpr int MOST_SPREADS = 4;

// Most iterations that see to approach velocities once bodies change by no more than asked for:
// between bodies of very different masses they fall too slowly to wait for.
constexpr int MOST_FOR_SPEED = 4;

// Share of what a body may change when all is solved, as an energy, from which on it is one that
// changes too much: where few remain, the others are well below what is asked for.
constexpr double LOCAL_SHARE = 0.25;

// Iterations begin anew when one changes more than the last by this factor; and the farthest that
// they go on, as a share. Found on sub-steps of shaken specimens of 364 and 1456 grains: farther,
// single grains are not solved, for friction is no gradient of anything.
constexpr double WORSE = 1.25;
constexpr double FARTHEST = 0.85;

// How far iterations extrapolate, as a share of what the last one changed.
class Pace {
  public:
    // `work`: what the last iteration changed, as an energy.
    double next(double work) {
        const bool worse = last_ > 0 && work > WORSE * last_;
        last_ = work;
        const double t = worse ? 1 : t_;
        t_ = worse ? 1 : (1 + std::sqrt(1 + 4 * t * t)) / 2;
        return worse ? 0 : std::min((t - 1) / t_, FARTHEST);
    }

  private:
    double t_ = 1;    // Nesterov's sequence
    double last_ = 0; // work
};

// Carries bodies and contacts through one step after another, of `law.substeps` sub-steps. In each
// the gaps and moment arms are what they have become, the external forces act, the contacts begin
// with the impulses of the sub-step before (the first with its share of those of the last step),
// and iterations correct them until they are solved. Normals are those of the beginning.
//
// Smaller steps of the solver do more for the same work than more iterations (Macklin et al. 2019,
// "Small steps in physics simulation"). Pairs end with the impulses of the whole step, bodies with
// their velocities at its end and their displacement.
template <class L> class Run {
    using N = typename Lane<L>::Number;

  public:
    // `inspection`, or null, is filled in the last sub-step.
    void step(Kernel<L> kernel, const Contacts &contacts, Inspection *inspection) {
        p_.contacts = &contacts;
        p_.kernel = kernel;
        load_all(contacts);
        begin(contacts);
        const int substeps = p_.all.packs.empty() ? 0 : contacts.law.substeps;
        for (int i = 0; i < substeps; ++i) {
            substep(i + 1 == substeps ? inspection : nullptr);
        }
        unload_all(contacts);
    }

  private:
    Problem<L> p_;
    int least_ = 0;            // iterations
    Sequence<L> now_{p_};      // what is to be done before the control goes on
    std::vector<int> touched_; // bodies
    Turn all_, asleep_;
    Few<L> few_{p_};

    // Calls `what` with every pack, by the thread at which it is at home.
    template <class F> static void at_home(const Contacts &contacts, const F &what) {
        const Homes &homes = contacts.homes;
        const std::size_t packs = homes.order().size();
        const Share all{packs, std::max<std::size_t>(1, packs), PACKS_AT_ONCE, homes.ends()};
        contacts.workers.share(&all, 1, [&](std::size_t, int, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                what(static_cast<std::size_t>(homes.order()[i]));
            }
        });
    }

    void load_all(const Contacts &contacts) {
        const std::size_t packs = contacts.colours.packs().size();
        const auto points = static_cast<std::size_t>(contacts.colours.points());
        p_.all.resize(packs, points);
        p_.memory.resize(points);
        p_.awake.resize(packs);
        p_.pairs = &p_.all;
        p_.law = lane_law<N>(contacts.law, contacts.substep);
        p_.bodies.resize(contacts.bodies.size());
        at_home(contacts, [&](std::size_t i) { load(contacts, i, p_); });
        contacts.workers.each(contacts.bodies.size(), BODIES_AT_ONCE,
                              [&](std::size_t i) { pack(contacts, i, p_.bodies); });
    }

    void unload_all(const Contacts &contacts) {
        at_home(contacts, [&](std::size_t i) { unload(p_, contacts, i); });
        contacts.workers.each(contacts.bodies.size(), BODIES_AT_ONCE, [&](std::size_t i) {
            SolverBody &body = contacts.bodies[i];
            const int number = static_cast<int>(i);
            if (!contacts.moves.still(number) && !contacts.colours.touched(number)) {
                fly(body, contacts.law.substeps, contacts.substep);
            } else {
                unpack(p_.bodies, i, body);
            }
        });
    }

    void begin(const Contacts &contacts) {
        least_ = (contacts.law.iterations + 1) / 2;
        now_.forget(); // what a step that failed has left
        few_.begin();
        const auto bodies = p_.bodies.motion.size();
        p_.active.assign(bodies, 0);
        p_.unsolved.assign(static_cast<std::size_t>(contacts.workers.count()), Unsolved<L>{});
        touched_.clear();
        for (int b = 1; b <= contacts.moves.all; ++b) {
            if (contacts.colours.touched(b)) {
                touched_.push_back(b);
            }
        }
    }

    void substep(Inspection *inspection) {
        now_.packs(Phase::Prepare);
        now_.bodies(Phase::IntegrateVelocities);
        now_.run();
        if (inspection != nullptr && inspection->record != nullptr) {
            record_bodies(p_.bodies, false, *inspection->record);
        }
        choose_awake();
        now_.colours(Phase::WarmStart, all_, false);
        iterate<Solved::Forces>(p_.law.unsolved_speed);
        find_motion();
        if (inspection != nullptr) {
            now_.run();
            inspect(*inspection);
        }
        now_.bodies(Phase::IntegratePositions);
        const N fastest = fastest_impact();
        if (!(fastest > 0)) {
            now_.packs(Phase::StoreForceImpulses);
            now_.run();
            return;
        }
        const N limit = std::max(p_.law.restitution_speed, fastest * IMPACT_SHARE<L>);
        now_.packs(Phase::BeginCompression);
        now_.bodies(Phase::KeepFreeMotion);
        now_.colours(Phase::TakeAway, all_, false);
        iterate<Solved::Impacts>(limit);
        find_motion();
        now_.packs(Phase::BeginRestitution);
        now_.bodies(Phase::KeepFreeMotion);
        iterate<Solved::Impacts>(limit);
        find_motion();
        now_.packs(Phase::StoreImpactImpulses);
        now_.run();
    }

    // The motion of bodies from the impulses that iterations have found: every visit to a contact
    // rounds it once more, and a loose grain may be visited thousands of times.
    void find_motion() {
        now_.bodies(Phase::RestoreFreeMotion);
        now_.colours(Phase::WarmStart, all_, false);
    }

    void choose_awake() {
        choose(p_.contacts->colours, p_.contacts->homes, all_,
               [&](std::size_t i) { return p_.awake[i] != 0; });
        choose(p_.contacts->colours, p_.contacts->homes, asleep_,
               [&](std::size_t i) { return p_.awake[i] == 0; });
    }

    Unsolved<L> take_unsolved() {
        Unsolved<L> all;
        for (Unsolved<L> &own : p_.unsolved) {
            all.speed = larger(all.speed, own.speed);
            all.fastest = larger(all.fastest, own.fastest);
            all.borne = larger(all.borne, own.borne);
            own = Unsolved<L>{};
        }
        return all;
    }

    BodyChange changed() const {
        BodyChange all;
        for (const BodyChange &one : p_.changes) {
            all.most = std::max(all.most, one.most);
            all.work += one.work;
            all.all += one.all;
            all.touched += one.touched;
            all.active += one.active;
        }
        return all;
    }

    // Begins iterations, the first of which extrapolates nothing.
    void begin_search(const Turn &turn, const std::vector<int> &bodies) {
        now_.packs(Phase::BeginSearchOfPoints, turn.packs);
        now_.bodies(Phase::BeginSearchOfBodies, bodies);
        p_.beta = L{};
    }

    // Goes over the contacts that are awake until they are solved: until an iteration changes
    // no body by more than asked for, and, of forces, no contact is approached faster than its
    // bias velocity by more than `limit`, for which there are MOST_FOR_SPEED iterations at most.
    // Of impacts, `limit` is what decides how much a body may change.
    //
    // The worst body counts, not all together: where one grain lags behind the forces on it, it
    // swings, and is never at rest. With few that might change by twice as much, grains under a
    // lid of 200 kPa crept numerically. Bodies count, not impulses: where several points hold a
    // body, impulses may wander among them while nothing moves.
    //
    // A contact that bears nothing and is not approached too fast is left as it is. So those that
    // are asleep are looked at in the first iteration, now and then, and when all others are
    // solved; they take part in all iterations from when one of their pack bears something.
    template <Solved WHAT> void iterate(N limit) {
        constexpr bool IMPACTS = WHAT == Solved::Impacts;
        const Phase forward = IMPACTS ? Phase::SolveImpactsForward : Phase::SolveForcesForward;
        const Phase backward = IMPACTS ? Phase::SolveImpactsBackward : Phase::SolveForcesBackward;
        const int packs = std::max(1, static_cast<int>(p_.all.packs.size()));
        const int few = IMPACTS ? SMALL_IMPACT_ITERATIONS : SMALL_ITERATIONS;
        const int least = std::max(least_, std::min(few, SMALL_WORK / packs));
        const int most = std::max(MOST_ITERATIONS, least);
        double left = static_cast<double>(most) * packs;
        // What a body may change.
        double allowed =
            IMPACTS ? 0.25 * static_cast<double>(limit) * static_cast<double>(limit) : 0;
        Pace pace;
        int local = 0;     // iterations over the few at hand
        int spread = 0;    // how often others became the few, since there were iterations over all
        int for_speed = 0; // iterations that changed no body by too much
        bool over_few = false;
        // Goes on with the few alone. Choosing them counts as an iteration over all packs.
        const auto begin_few = [&] {
            few_.choose();
            p_.pairs = &p_.few;
            begin_search(few_.turn(), few_.bodies());
            left -= packs;
            local = 0;
            pace = Pace{};
        };
        now_.packs(Phase::BeginSearchOfPoints);
        now_.bodies(Phase::BeginSearchOfBodies, touched_);
        p_.beta = L{};
        for (int n = 1; left > 0; ++n) {
            const Turn &turn = over_few ? few_.turn() : all_;
            const std::vector<int> &bodies = over_few ? few_.bodies() : touched_;
            p_.limit = LOCAL_SHARE * allowed;
            now_.colours(forward, turn, false);
            now_.colours(backward, turn, true);
            now_.change(IMPACTS ? Phase::FindChangeByImpacts : Phase::FindChangeByForces, bodies);
            now_.run();
            left -= std::max<double>(1, static_cast<double>(turn.packs.size()));
            const Unsolved<L> unsolved = take_unsolved();
            const BodyChange changed = this->changed();
            if (over_few) {
                if (++local < LOCAL_ITERATIONS && changed.most > p_.limit) {
                    extrapolate(bodies, changed.work, pace);
                    continue;
                }
                few_.put_back();
                if (++spread < MOST_SPREADS && few_.spread(IMPACTS, p_.limit)) {
                    begin_few();
                    continue;
                }
                over_few = false;
                p_.pairs = &p_.all;
                // Going far at once would undo what the few have got.
                pace = Pace{};
                begin_search(all_, touched_);
                continue;
            }
            if (!IMPACTS) {
                allowed = changed.touched > 0 ? p_.law.unsolved_share * p_.law.unsolved_share *
                                                    changed.all / changed.touched
                                              : 0;
            }
            const bool few_left = changed.active * FEW < static_cast<int>(touched_.size());
            const bool still = n >= least && changed.most <= allowed;
            const bool met_slowly = IMPACTS || !any_larger(unsolved.speed, limit);
            for_speed += still && !met_slowly;
            const bool solved = still && (met_slowly || for_speed >= MOST_FOR_SPEED);
            if ((n == 1 || n % least == 0 || solved) && !wake<WHAT>(backward) && solved) {
                break;
            }
            if ((IMPACTS || n >= least) && few_left && changed.active > 0 && !still) {
                begin_few();
                over_few = true;
                spread = 0;
                continue;
            }
            extrapolate(bodies, changed.work, pace);
        }
        // Where iterations ran out: what was to come next would move bodies, not their impulses.
        now_.forget();
        if (over_few) {
            few_.put_back();
            p_.pairs = &p_.all;
        }
    }

    // Goes on as the last iteration did, the farther the more of them there were since it
    // began anew.
    void extrapolate(const std::vector<int> &bodies, double work, Pace &pace) {
        p_.beta = L{} + static_cast<N>(pace.next(work));
        now_.bodies(Phase::Extrapolate, bodies);
    }

    // Looks at the pairs that are asleep. Whether one woke. Mostly none does, which is found in any
    // order; else they are visited colour by colour, for one may wake the next.
    template <Solved WHAT> bool wake(Phase backward) {
        if (asleep_.packs.empty()) {
            return false;
        }
        now_.packs(WHAT == Solved::Impacts ? Phase::AskForImpacts : Phase::AskForForces,
                   asleep_.packs);
        now_.run();
        if (!any_larger(take_unsolved().borne, N(0))) {
            return false;
        }
        p_.beta = L{};
        now_.colours(backward, asleep_, true);
        now_.run();
        take_unsolved();
        bool any = false;
        for (const int number : asleep_.packs) {
            const auto i = static_cast<std::size_t>(number);
            const Pack<L> &pack = p_.all.packs[i];
            if (bears(pack, &p_.all.points[pack.first])) {
                p_.awake[i] = 1;
                any = true;
            }
        }
        if (any) {
            choose_awake();
        }
        return any;
    }

    void inspect(Inspection &inspection) {
        p_.residual = Residual{};
        p_.kernel(Phase::AddResidual, p_, {nullptr, 0, 0, 0, p_.all.packs.size()});
        inspection.residual = p_.residual;
        if (inspection.record == nullptr) {
            return;
        }
        record_bodies(p_.bodies, true, *inspection.record);
        inspection.record->contacts.clear();
        for (const Pack<L> &pack : p_.all.packs) {
            const auto first = static_cast<std::size_t>(pack.first);
            record_contacts(pack, &p_.all.points[first], &p_.memory[first], p_.contacts->places,
                            *inspection.record);
        }
    }

    N fastest_impact() {
        now_.packs(Phase::FindFastestImpact);
        now_.run();
        const L found = take_unsolved().fastest;
        N fastest = 0;
        for (int i = 0; i < Lane<L>::WIDTH; ++i) {
            fastest = std::max(fastest, Lane<L>::get(found, i));
        }
        return fastest;
    }
};

} // namespace pluvia
