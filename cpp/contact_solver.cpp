#include "contact_solver.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

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

Symmetric<double> symmetric(const btMatrix3x3 &m) {
    const auto at = [&m](int i, int j) { return static_cast<double>(m[i][j]); };
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
                                   btPersistentManifold **manifolds, int manifold_count,
                                   btTypedConstraint **, int constraint_count,
                                   const btContactSolverInfo &info, btIDebugDraw *,
                                   btDispatcher *) {
    if (constraint_count != 0) {
        throw std::logic_error("the contact solver does not know joints");
    }
    // Bullet calls once more when all islands are done, with nothing.
    if (body_count == 0 && manifold_count == 0) {
        return 0;
    }
    const double step = static_cast<double>(info.m_timeStep);
    take_bodies(bodies, body_count);
    make_rows(manifolds, manifold_count, step);
    apply_forces(step);
    iterations_.run(sweep_, info.m_numIterations, rows_, solver_bodies_);
    for (const ContactRow &row : rows_) {
        write_row(row);
    }
    give_back(step);
    return 0;
}

void ContactSolver::take_bodies(btCollisionObject **bodies, int count) {
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
            out.inverse_inertia = symmetric(body->getInvInertiaTensorWorld());
        }
        body->setCompanionId(static_cast<int>(solver_bodies_.size()));
        solver_bodies_.push_back(out);
        bodies_.push_back(body);
    }
}

void ContactSolver::make_rows(btPersistentManifold **manifolds, int count, double step) {
    rows_.clear();
    for (int m = 0; m < count; ++m) {
        btPersistentManifold &manifold = *manifolds[m];
        const btCollisionObject *on_a = manifold.getBody0();
        const btCollisionObject *on_b = manifold.getBody1();
        if (!on_a->hasContactResponse() || !on_b->hasContactResponse()) {
            continue;
        }
        const int a = index_of(on_a);
        const int b = index_of(on_b);
        const SolverBody &body_a = solver_bodies_[static_cast<std::size_t>(a)];
        const SolverBody &body_b = solver_bodies_[static_cast<std::size_t>(b)];
        if (body_a.inverse_mass == 0 && body_b.inverse_mass == 0) {
            continue;
        }
        for (int p = 0; p < manifold.getNumContacts(); ++p) {
            rows_.push_back(
                make_row(law_, step, a, b, body_a, body_b, on_a->getWorldTransform().getOrigin(),
                         on_b->getWorldTransform().getOrigin(), manifold.getContactPoint(p)));
        }
    }
}

void ContactSolver::apply_forces(double step) {
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
        SolverBody &body = solver_bodies_[i];
        if (body.inverse_mass > 0) {
            body.velocity =
                body.velocity + three(bodies_[i]->getTotalForce()) * (body.inverse_mass * step);
            body.spin =
                body.spin + body.inverse_inertia * three(bodies_[i]->getTotalTorque()) * step;
        }
    }
}

// Bullet turns a body by the spin it is given. A free body's spin changes
// while it turns; the spin it has half a step on, from its constant angular
// momentum, turns it right to the second order (midpoint rule).
void ContactSolver::give_back(double step) {
    turning_.clear();
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
        const SolverBody &from = solver_bodies_[i];
        if (from.inverse_mass == 0) {
            continue;
        }
        btRigidBody &body = *bodies_[i];
        body.setLinearVelocity(vector(from.velocity));
        btVector3 spin = vector(from.spin);
        const btVector3 inertia = moments(body);
        if (gyroscopic_ && !even(inertia)) {
            const btMatrix3x3 &basis = body.getWorldTransform().getBasis();
            const btVector3 momentum = momentum_of(spin, inertia, basis);
            turning_.push_back({&body, three(momentum)});
            const btScalar half = static_cast<btScalar>(step / 2);
            spin = spin_of(momentum, body.getInvInertiaDiagLocal(), turned(basis, spin, half));
        }
        body.setAngularVelocity(spin);
        body.setCompanionId(-1);
    }
}

void ContactSolver::after_step() {
    for (const Turning &turning : turning_) {
        btRigidBody &body = *turning.body;
        body.setAngularVelocity(spin_of(vector(turning.momentum), body.getInvInertiaDiagLocal(),
                                        body.getWorldTransform().getBasis()));
    }
    turning_.clear();
}

} // namespace pluvia
