#include "contact_solver.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <cmath>
#include <stdexcept>

namespace pluvia {

namespace {

Three<double> three(const btVector3 &v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

btVector3 vector(const Three<double> &v) {
    return btVector3(static_cast<btScalar>(v.x), static_cast<btScalar>(v.y),
                     static_cast<btScalar>(v.z));
}

// What is diagonal in body axes, in world axes.
Symmetric<double> along(const btMatrix3x3 &basis, const btVector3 &diagonal) {
    const auto at = [&](int i, int j) {
        return static_cast<double>((basis[i] * diagonal).dot(basis[j]));
    };
    return {at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(0, 2), at(1, 2)};
}

// The moments of inertia about the body axes; Bullet keeps their inverses.
btVector3 moments(const btRigidBody &body) {
    const btVector3 &inverse = body.getInvInertiaDiagLocal();
    return btVector3(1 / inverse.x(), 1 / inverse.y(), 1 / inverse.z());
}

btVector3 spin_of(const btVector3 &momentum, const btVector3 &inverse, const btMatrix3x3 &basis) {
    return basis * ((momentum * basis) * inverse);
}

btVector3 momentum_of(const btVector3 &spin, const btVector3 &moments, const btMatrix3x3 &basis) {
    return basis * ((spin * basis) * moments);
}

// A basis turned by a spin for a time.
btMatrix3x3 turned(const btMatrix3x3 &basis, const btVector3 &spin, btScalar time) {
    const btScalar rate = spin.length();
    if (rate * time < btScalar(1e-12)) {
        return basis;
    }
    return btMatrix3x3(btQuaternion(spin / rate, rate * time)) * basis;
}

bool even(const btVector3 &m) { return m.x() == m.y() && m.y() == m.z(); }

} // namespace

int ContactSolver::index_of(const btCollisionObject *body) const {
    return body->getCompanionId() >= 0 ? body->getCompanionId() : 0;
}

btScalar ContactSolver::solveGroup(btCollisionObject **bodies, int body_count,
                                   btPersistentManifold **, int, btTypedConstraint **,
                                   int constraint_count, const btContactSolverInfo &info,
                                   btIDebugDraw *, btDispatcher *) {
    if (constraint_count != 0) {
        throw std::logic_error("the contact solver does not know joints");
    }
    const double step = static_cast<double>(info.m_timeStep);
    take_bodies(bodies, body_count, step);
    make_rows(step);
    iterations_.run(sweep_, law_, step, rows_, solver_bodies_);
    for (const ContactRow &row : rows_) {
        write_row(row);
    }
    give_back(step);
    return 0;
}

void ContactSolver::take_bodies(btCollisionObject **bodies, int count, double step) {
    solver_bodies_.assign(1, SolverBody{});
    bodies_.assign(1, nullptr);
    for (int i = 0; i < count; ++i) {
        btRigidBody *body = btRigidBody::upcast(bodies[i]);
        // What is driven counts as static with Bullet, too.
        if (body == nullptr || (body->isStaticObject() && !body->isKinematicObject())) {
            bodies[i]->setCompanionId(-1);
            continue;
        }
        SolverBody out;
        out.velocity = three(body->getLinearVelocity());
        out.spin = three(body->getAngularVelocity());
        if (!body->isKinematicObject()) {
            out.inverse_mass = static_cast<double>(body->getInvMass());
            const btMatrix3x3 &basis = body->getWorldTransform().getBasis();
            const btVector3 &inverse = body->getInvInertiaDiagLocal();
            const btVector3 root(std::sqrt(inverse.x()), std::sqrt(inverse.y()),
                                 std::sqrt(inverse.z()));
            out.inverse_inertia_root = along(basis, root);
            out.inertia_root = along(basis, btVector3(1 / root.x(), 1 / root.y(), 1 / root.z()));
            out.acceleration = three(body->getTotalForce()) * out.inverse_mass;
            out.spin_up = three(body->getInvInertiaTensorWorld() * body->getTotalTorque());
        } else {
            accelerate_driven(body, step, out);
        }
        body->setCompanionId(static_cast<int>(solver_bodies_.size()));
        solver_bodies_.push_back(out);
        bodies_.push_back(body);
    }
}

namespace {

// The smaller of two changes where they have one sign, else none.
double steady(double a, double b) { return a * b <= 0 ? 0 : std::abs(a) < std::abs(b) ? a : b; }

Three<double> steady(const Three<double> &a, const Three<double> &b) {
    return {steady(a.x, b.x), steady(a.y, b.y), steady(a.z, b.z)};
}

} // namespace

// Bullet knows a driven body's mean velocity in the step. Were it the velocity
// of every sub-step, it would jump from step to step, and what rubs on the body
// could not follow within one sub-step. So it changes steadily through the
// step, as it has changed in the last two; where it did jump, it jumps.
void ContactSolver::accelerate_driven(const btCollisionObject *body, double step,
                                      SolverBody &driven) {
    Drive &last = drives_[body];
    const Three<double> change = driven.velocity - last.velocity;
    const Three<double> spin_change = driven.spin - last.spin;
    driven.acceleration = steady(change, last.change) * (1 / step);
    driven.spin_up = steady(spin_change, last.spin_change) * (1 / step);
    last = {driven.velocity, driven.spin, change, spin_change};
}

void ContactSolver::make_rows(double step) {
    rows_.clear();
    for (const Touching &pair : touching_) {
        const int a = index_of(pair.a->object);
        const int b = index_of(pair.b->object);
        const SolverBody &body_a = solver_bodies_[static_cast<std::size_t>(a)];
        const SolverBody &body_b = solver_bodies_[static_cast<std::size_t>(b)];
        if (body_a.inverse_mass == 0 && body_b.inverse_mass == 0) {
            continue;
        }
        for (int p = 0; p < pair.state->memory.last.count; ++p) {
            rows_.push_back(make_row(law_, step, pair, p, a, b, body_a, body_b));
        }
    }
}

// Bullet moves a body by its velocity and turns it by its spin, for a step:
// they are given as what takes it the way it has gone. A free body's spin
// changes while it turns; the spin it has half a step on, from the angular
// momentum it had on average, turns it right to the second order (midpoint
// rule).
void ContactSolver::give_back(double step) {
    moving_.clear();
    const double rate = 1 / step;
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
        const SolverBody &from = solver_bodies_[i];
        if (from.inverse_mass == 0) {
            continue;
        }
        btRigidBody &body = *bodies_[i];
        Moving moving{&body, from.velocity, from.spin, false};
        btVector3 spin = vector(from.turn * rate);
        const btVector3 inertia = moments(body);
        if (gyroscopic_ && !even(inertia)) {
            const btMatrix3x3 &basis = body.getWorldTransform().getBasis();
            moving.spin = three(momentum_of(vector(from.spin), inertia, basis));
            moving.is_momentum = true;
            const btScalar half = static_cast<btScalar>(step / 2);
            spin = spin_of(momentum_of(spin, inertia, basis), body.getInvInertiaDiagLocal(),
                           turned(basis, spin, half));
        }
        moving_.push_back(moving);
        body.setLinearVelocity(vector(from.shift * rate));
        body.setAngularVelocity(spin);
        body.setCompanionId(-1);
    }
}

void ContactSolver::after_step() {
    for (const Moving &moving : moving_) {
        btRigidBody &body = *moving.body;
        body.setLinearVelocity(vector(moving.velocity));
        body.setAngularVelocity(moving.is_momentum
                                    ? spin_of(vector(moving.spin), body.getInvInertiaDiagLocal(),
                                              body.getWorldTransform().getBasis())
                                    : vector(moving.spin));
    }
    moving_.clear();
}

} // namespace pluvia
