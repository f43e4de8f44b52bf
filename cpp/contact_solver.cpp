#include "contact_solver.h"

#include "pluvia/src/world/bullet/ffi.rs.h"
#include "prefetch.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pluvia {

namespace {

// Numbers of bodies, kept as Bullet's companion ids: free bodies count from 0
// upwards, driven ones from -2 downwards; -1 is the world.
constexpr int WORLD = -1;

int driven_number(int id) { return WORLD - 1 - id; }

// So many bodies or pairs ahead the memory is asked for them.
constexpr std::size_t AHEAD = 4;

// Steps from one that is looked at to the next: looking costs about as much as a sweep.
constexpr unsigned LOOK_EVERY = 16;

// Bodies or pairs that a thread takes at once.
constexpr std::size_t AT_ONCE = 64;

} // namespace

ContactSolver::ContactSolver(const std::vector<Touching> &touching, const ContactLaw &law,
                             Sweep sweep, bool gyroscopic, Workers &workers)
    : touching_(touching), law_(law), sweep_(sweep), gyroscopic_(gyroscopic), workers_(workers),
      desks_(static_cast<std::size_t>(workers.count())) {}

btScalar ContactSolver::solveGroup(btCollisionObject **, int, btPersistentManifold **, int,
                                   btTypedConstraint **, int constraint_count,
                                   const btContactSolverInfo &info, btIDebugDraw *,
                                   btDispatcher *) {
    if (constraint_count != 0) {
        throw std::logic_error("the contact solver does not know joints");
    }
    const double step = static_cast<double>(info.m_timeStep);
    take_driven(step);
    links_.clear();
    for (const Touching &pair : touching_) {
        links_.push_back({pair.a->number, pair.b->number});
    }
    parts_.split(moving_.size(), links_);
    for (Desk &desk : desks_) {
        desk.local.assign(driven_.size(), 0);
    }
    begin_look();
    // A part that is more than a thread's share is solved by all of them.
    small_.clear();
    const std::size_t share = links_.size() / desks_.size();
    for (std::size_t part = 0; part < parts_.count(); ++part) {
        if (desks_.size() > 1 && parts_.pairs(part).size() > share) {
            solve_part(part, step, desks_[0], &workers_);
        } else {
            small_.push_back(part);
        }
    }
    workers_.share(small_.size(), 1, [&](int worker, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            solve_part(small_[i], step, desks_[static_cast<std::size_t>(worker)], nullptr);
        }
    });
    end_look();
    return 0;
}

void ContactSolver::begin_look() {
    const bool look = recording_ || steps_++ % LOOK_EVERY == 0;
    looks_.assign(look ? parts_.count() : 0, Look{});
    records_.assign(recording_ ? parts_.count() : 0, SubstepRecord{});
    for (std::size_t part = 0; part < records_.size(); ++part) {
        looks_[part].record = &records_[part];
    }
}

// In the order of the parts, whoever solved them.
void ContactSolver::end_look() {
    Residual all;
    for (const Look &look : looks_) {
        all.error += look.residual.error;
        all.impulse += look.residual.impulse;
    }
    if (!looks_.empty()) {
        residual_ = all.impulse > 0 ? std::sqrt(all.error / all.impulse) : 0;
    }
    recorded_ = SubstepRecord{};
    for (const SubstepRecord &record : records_) {
        recorded_.append(record);
    }
}

void ContactSolver::bodies_changed() {
    moving_.clear();
    driving_.clear();
    driven_.clear();
    sorted_ = false;
}

void ContactSolver::sort_bodies(const btCollisionObjectArray &bodies) {
    if (sorted_) {
        return;
    }
    bodies_changed();
    for (int i = 0; i < bodies.size(); ++i) {
        btRigidBody *body = btRigidBody::upcast(bodies[i]);
        // What is driven counts as static with Bullet, too.
        if (body != nullptr && body->isKinematicObject()) {
            bodies[i]->setCompanionId(driven_number(static_cast<int>(driving_.size())));
            driving_.push_back(body);
        } else if (body == nullptr || body->isStaticObject()) {
            bodies[i]->setCompanionId(WORLD);
        } else {
            bodies[i]->setCompanionId(static_cast<int>(moving_.size()));
            moving_.emplace_back();
            moving_.back().body = body;
        }
    }
    place_.resize(moving_.size());
    sorted_ = true;
}

void ContactSolver::take_driven(double step) {
    driven_.clear();
    drives_now_.clear();
    for (const btRigidBody *body : driving_) {
        const int number = body->getUserIndex();
        Drive &drive = drives_now_[number];
        const auto before = drives_.find(number);
        drive = before != drives_.end() ? before->second : Drive{};
        driven_.push_back(driven_body(*body, step, drive));
    }
    std::swap(drives_, drives_now_);
}

void ContactSolver::read_drives(const Units &units, rust::Vec<DriveRead> &out) const {
    const auto metres = [&](const Three<double> &v) {
        return std::array<double, 3>{v.x / units.scale(), v.y / units.scale(), v.z / units.scale()};
    };
    for (std::size_t i = 0; i < driven_.size(); ++i) {
        const SolverBody &body = driven_[i];
        DriveRead read{};
        read.id = static_cast<std::uint32_t>(driving_[i]->getUserIndex());
        read.velocity = metres(body.velocity);
        read.acceleration = metres(body.acceleration);
        read.spin = {body.spin.x, body.spin.y, body.spin.z};
        read.spin_up = {body.spin_up.x, body.spin_up.y, body.spin_up.z};
        out.push_back(read);
    }
}

// Driven bodies come to a desk when a pair of the part has them.
int ContactSolver::local_index(int id, Desk &desk) const {
    if (id > WORLD) {
        return place_[static_cast<std::size_t>(id)];
    }
    if (id == WORLD) {
        return 0;
    }
    const int driven = driven_number(id);
    int &local = desk.local[static_cast<std::size_t>(driven)];
    if (local == 0) {
        local = static_cast<int>(desk.bodies.size());
        desk.bodies.push_back(driven_[static_cast<std::size_t>(driven)]);
        desk.driven_in.push_back(driven);
    }
    return local;
}

// Reads and writes only what belongs to the part, and of that each thread only
// what belongs to the pairs and bodies it has taken.
void ContactSolver::solve_part(std::size_t part, double step, Desk &desk, Workers *workers) {
    const auto share = [workers](std::size_t size, const auto &range) {
        if (workers == nullptr) {
            range(std::size_t{0}, size);
        } else {
            workers->share(size, AT_ONCE,
                           [&](int, std::size_t begin, std::size_t end) { range(begin, end); });
        }
    };
    const Parts::Range bodies = parts_.bodies(part);
    const auto body_at = [&](std::size_t i) -> Moving & {
        return moving_[static_cast<std::size_t>(bodies.first[i])];
    };
    desk.bodies.assign(bodies.size() + 1, SolverBody{});
    share(bodies.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i + AHEAD < end) {
                prefetch_body(*body_at(i + AHEAD).body);
            }
            place_[static_cast<std::size_t>(bodies.first[i])] = static_cast<int>(i + 1);
            desk.bodies[i + 1] = free_body(*body_at(i).body);
        }
    });
    desk.pairs.clear();
    std::size_t rows = 0;
    for (const int &number : parts_.pairs(part)) {
        const Touching &pair = touching_[static_cast<std::size_t>(number)];
        const int a = local_index(pair.a->number, desk);
        const int b = local_index(pair.b->number, desk);
        desk.pairs.push_back({&pair, a, b, rows});
        rows += static_cast<std::size_t>(pair.points);
    }
    desk.rows.resize(rows);
    share(desk.pairs.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i + AHEAD < end) {
                prefetch(*desk.pairs[i + AHEAD].pair->state);
            }
            const auto &[pair, a, b, first] = desk.pairs[i];
            for (int p = 0; p < pair->points; ++p) {
                desk.rows[first + static_cast<std::size_t>(p)] =
                    make_row(law_, step, *pair, p, a, b, desk.bodies[static_cast<std::size_t>(a)],
                             desk.bodies[static_cast<std::size_t>(b)]);
            }
        }
    });
    desk.iterations.run(sweep_, law_, step, desk.rows, desk.bodies,
                        looks_.empty() ? nullptr : &looks_[part]);
    share(desk.pairs.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (int p = 0; p < desk.pairs[i].pair->points; ++p) {
                write_row(desk.rows[desk.pairs[i].first + static_cast<std::size_t>(p)]);
            }
        }
    });
    share(bodies.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const SolverBody &body = desk.bodies[i + 1];
            Moving &moving = body_at(i);
            moving = {moving.body, body.velocity, body.spin, body.shift, body.turn};
        }
    });
    for (const int driven : desk.driven_in) {
        desk.local[static_cast<std::size_t>(driven)] = 0;
    }
    desk.driven_in.clear();
}

void ContactSolver::move_bodies(double step) {
    workers_.share(moving_.size(), AT_ONCE, [&](int, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i + AHEAD < end) {
                prefetch(*moving_[i + AHEAD].body);
            }
            move_body(moving_[i], step, gyroscopic_);
        }
    });
}

} // namespace pluvia
