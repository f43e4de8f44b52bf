// The entry to the native contact solver: numbers the bodies, collects the pairs, has the step
// solved and moves the bodies.
#include "contact_solver.h"

#include "contact_run.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "pool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace pluvia {

namespace {

// How many bodies or pairs ahead the memory is asked for them.
constexpr std::size_t AHEAD = 4;

// Steps from one whose solution is inspected to the next: one thread goes over all contacts for it.
constexpr unsigned INSPECT_EVERY = 16;

// Slices of the specimen by which bodies are sorted.
constexpr std::size_t SLICES = 1024;

// Bodies or pairs that a thread takes at once.
constexpr std::size_t AT_ONCE = 64;

// The home of a body that does not move.
constexpr std::uint16_t NOWHERE = 0xffff;

// Whether a point of a pair may well bear something in the step.
bool is_near(const ContactLaw &law, double step, const Touching &pair, const SolverBody &a,
             const SolverBody &b) {
    const Vec normal = normal_of(pair);
    for (int p = 0; p < pair.points; ++p) {
        if (three(pair.state->loads[p].impulse).dot(normal) > 0) {
            return true;
        }
        const Arms arms(pair, p);
        const Vec speed_a = a.velocity + a.spin.cross(arms.a);
        const Vec speed_b = b.velocity + b.spin.cross(arms.b);
        const double parting = (speed_a - speed_b).dot(normal);
        const double gap = static_cast<double>(pair.state->memory.last.points[p].gap);
        if (gap + std::min(0.0, parting * step) <= law.closed_gap) {
            return true;
        }
    }
    return false;
}

// By what every processor has.
template <class L> void portable(Phase phase, Problem<L> &problem, const Part &part) {
    run_phase(phase, problem, part);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void avx2(Phase phase, Problem<Float8> &problem, const Part &part) {
    run_phase(phase, problem, part);
}
#endif

Kernel<Float8> kernel_of([[maybe_unused]] const WorldDefinition &d) {
#if defined(__x86_64__)
    if (!d.portable && has_avx2()) {
        return &avx2;
    }
#endif
    return &portable<Float8>;
}

ContactLaw law_of(const WorldDefinition &d, double scale) {
    return {d.substeps,
            d.native_iterations,
            d.contact_stiffness,
            d.contact_damping_ratio,
            d.max_depenetration_velocity * scale,
            d.restitution_velocity_threshold * scale,
            d.tolerances.closed_gap * scale,
            d.tolerances.unsolved_gap * scale,
            d.solver_tolerance};
}

} // namespace

ContactSolver::ContactSolver(const std::vector<Touching> &touching, const Units &units,
                             const WorldDefinition &d, Workers &workers)
    : touching_(touching), law_(law_of(d, units.scale())), one_by_one_(d.contacts_at_once == 1),
      gyroscopic_(d.gyroscopic), kernel_(kernel_of(d)), workers_(workers),
      single_(std::make_unique<Run<double>>()), eight_(std::make_unique<Run<Float8>>()) {}

ContactSolver::~ContactSolver() = default;

void ContactSolver::solve(double step) {
    const auto free = static_cast<int>(moving_.size());
    const Moves moves{free, free + static_cast<int>(pressed_.size())};
    take_bodies(step);
    take_pairs(step);
    colours_.sort(places_, moves, one_by_one_ ? 1 : Lane<Float8>::WIDTH);
    homes_.find(colours_, places_, moves, workers_.count());
    body_homes_.assign(place_.size(), NOWHERE);
    for (std::size_t i = 0; i < place_.size(); ++i) {
        if (!moves.still(place_[i])) {
            body_homes_[i] = static_cast<std::uint16_t>(homes_.of_body(place_[i]));
        }
    }
    Inspection inspection;
    recorded_ = SubstepRecord{};
    inspection.record = recording_ ? &recorded_ : nullptr;
    const bool inspects = recording_ || steps_++ % INSPECT_EVERY == 0;
    const Contacts contacts{
        law_, step / law_.substeps, touching_, places_, colours_, homes_, moves, bodies_, workers_};
    Inspection *const last = inspects ? &inspection : nullptr;
    if (one_by_one_) {
        single_->step(&portable<double>, contacts, last);
    } else {
        eight_->step(kernel_, contacts, last);
    }
    if (inspects) {
        const Residual &residual = inspection.residual;
        residual_ = residual.impulse > 0 ? std::sqrt(residual.error / residual.impulse) : 0;
    }
}

void ContactSolver::take_pairs(double step) {
    places_.resize(touching_.size());
    const auto take = [&](std::size_t i) {
        const Touching &pair = touching_[i];
        const int a = place_[pair.a->number];
        const int b = place_[pair.b->number];
        places_[i] = {a, b, static_cast<std::int16_t>(pair.points),
                      is_near(law_, step, pair, bodies_[a], bodies_[b])};
    };
    workers_.each(touching_.size(), AT_ONCE, take, AHEAD,
                  [&](std::size_t i) { prefetch(*touching_[i].state); });
}

void ContactSolver::bodies_changed() {
    moving_.clear();
    pressed_.clear();
    kinematic_.clear();
    parts_.clear();
    bodies_.clear();
    sorted_ = false;
}

void ContactSolver::sort_bodies(const btCollisionObjectArray &bodies) {
    if (sorted_) {
        return;
    }
    bodies_changed();
    std::vector<btRigidBody *> by_number;
    for (int i = 0; i < bodies.size(); ++i) {
        btRigidBody *body = btRigidBody::upcast(bodies[i]);
        const int number = body->getUserIndex();
        place_.resize(std::max<std::size_t>(place_.size(), number + 1));
        place_[number] = 0;
        by_number.resize(place_.size());
        by_number[number] = body;
        // Kinematic bodies count as static with Bullet, too.
        if (whole_of(number) != number) {
            parts_.push_back({body, nullptr});
        } else if (presses_.count(number) != 0) {
            presses_.at(number).hold(*body);
            pressed_.push_back(body);
        } else if (body->isKinematicObject()) {
            kinematic_.push_back(body);
        } else if (!body->isStaticObject()) {
            moving_.push_back({body, number});
        }
    }
    for (Part &part : parts_) {
        part.whole = by_number.at(whole_of(part.own->getUserIndex()));
        const auto press = presses_.find(part.whole->getUserIndex());
        if (press != presses_.end()) {
            press->second.hold(*part.own);
        }
    }
    int next = 1 + static_cast<int>(moving_.size());
    for (const auto *list : {&pressed_, &kinematic_}) {
        for (const btRigidBody *body : *list) {
            place_[body->getUserIndex()] = next++;
        }
    }
    sorted_ = true;
}

// Free bodies in the order of places along the axis along which they are spread most.
void ContactSolver::sort_places() {
    const std::size_t count = moving_.size();
    centres_.resize(count);
    const auto take = [&](std::size_t i) {
        centres_[i] = three(moving_[i].body->getWorldTransform().getOrigin());
    };
    workers_.each(count, AT_ONCE, take, AHEAD,
                  [&](std::size_t i) { prefetch(moving_[i].body->getWorldTransform()); });
    if (count == 0) {
        return;
    }
    Vec low = centres_[0], high = low;
    for (const Vec &c : centres_) {
        low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
        high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
    }
    const Vec size = high - low;
    const auto along = size.z >= size.x && size.z >= size.y ? &Vec::z
                       : size.x >= size.y                   ? &Vec::x
                                                            : &Vec::y;
    const double length = std::max(size.*along, 1e-30);
    std::array<int, SLICES + 1> begin{};
    const auto slice = [&](const Vec &c) {
        const double share = (c.*along - low.*along) / length;
        return share >= 0 && share < 1 ? static_cast<std::size_t>(share * SLICES) : SLICES - 1;
    };
    for (const Vec &c : centres_) {
        ++begin[slice(c) + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (std::size_t i = 0; i < count; ++i) {
        place_[moving_[i].number] = 1 + begin[slice(centres_[i])]++;
    }
}

void ContactSolver::take_bodies(double step) {
    sort_places();
    for (const Part &part : parts_) {
        place_[part.own->getUserIndex()] = place_[part.whole->getUserIndex()];
    }
    bodies_.resize(1 + moving_.size() + pressed_.size() + kinematic_.size());
    bodies_[0] = SolverBody{};
    const auto take = [&](std::size_t i) {
        bodies_[place_[moving_[i].number]] = free_body(*moving_[i].body);
    };
    workers_.each(moving_.size(), AT_ONCE, take, AHEAD,
                  [&](std::size_t i) { prefetch_body(*moving_[i].body); });
    for (const btRigidBody *body : pressed_) {
        const int number = body->getUserIndex();
        bodies_[place_[number]] = pressed_body(*body, presses_.at(number));
    }
    for (const btRigidBody *body : kinematic_) {
        const int number = body->getUserIndex();
        bodies_[place_[number]] = kinematic_body(*body, step, drives_[number]);
    }
}

void ContactSolver::read_drives(const Units &units, rust::Vec<DriveRead> &out) const {
    const std::size_t first = 1 + moving_.size() + pressed_.size();
    for (std::size_t i = first; i < bodies_.size(); ++i) {
        const SolverBody &body = bodies_[i];
        const auto id = static_cast<std::uint32_t>(kinematic_[i - first]->getUserIndex());
        out.push_back(DriveRead{id, units.metres(body.velocity), units.metres(body.acceleration),
                                array(body.spin), array(body.spin_up)});
    }
}

void ContactSolver::take_gains(double gravity, double step, double margin, bool goes_on,
                               Gains &gains) {
    // What is gained evenly in all sub-steps moves a body by this share of it.
    const double mean = (law_.substeps + 1) / (2.0 * law_.substeps);
    gains.free = std::max(0.0, gravity * step * mean - margin / 2 / step);
    gains.others.clear();
    for (const btRigidBody *body : pressed_) {
        const int number = body->getUserIndex();
        gains.others.push_back({number, presses_.at(number).gain(*body, step, goes_on) * mean});
    }
    for (const auto &[own, whole] : parts_) {
        for (std::size_t i = 0; i < pressed_.size(); ++i) {
            if (pressed_[i] == whole) {
                gains.others.push_back({own->getUserIndex(), gains.others[i].speed});
            }
        }
    }
}

void ContactSolver::carry_parts() {
    for (const auto &[own, whole] : parts_) {
        // Those of other bodies got theirs in `move_bodies`.
        if (whole->isKinematicObject() && presses_.count(whole->getUserIndex()) == 0) {
            own->setLinearVelocity(whole->getLinearVelocity());
            own->setAngularVelocity(whole->getAngularVelocity());
        }
    }
}

void ContactSolver::move_bodies(double step) {
    const auto move = [&](std::size_t i) {
        move_body(*moving_[i].body, bodies_[place_[moving_[i].number]], step, gyroscopic_);
    };
    workers_.each(moving_.size(), AT_ONCE, move, AHEAD,
                  [&](std::size_t i) { prefetch(*moving_[i].body); });
    for (btRigidBody *body : pressed_) {
        const int number = body->getUserIndex();
        move_pressed(*body, bodies_[place_[number]], presses_.at(number));
    }
    for (const auto &[own, whole] : parts_) {
        own->setWorldTransform(whole->getWorldTransform());
        own->setLinearVelocity(whole->getLinearVelocity());
        own->setAngularVelocity(whole->getAngularVelocity());
    }
}

} // namespace pluvia
