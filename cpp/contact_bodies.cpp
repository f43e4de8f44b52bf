// Reads each body from Bullet into the solver's own form, and moves it by what the solver found.
#include "contact_bodies.h"

#include "convert.h"
#include "pool.h"
#include "shapes.h"

#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

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

// A vector times what is diagonal in body axes: a spin times the moments of inertia, or an angular
// momentum times their inverses.
btVector3 times(const btVector3 &v, const btVector3 &diagonal, const btMatrix3x3 &basis) {
    return basis * ((v * basis) * diagonal);
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

// How a velocity changes in a step, from its mean's change `a` since the step before and the change
// `b` before that: carried on to the middle of the step, where both have one sign and about one
// size, so that its end is where the next step begins; none where it jumps.
double steady(double a, double b) {
    if (a * b <= 0) {
        return 0;
    }
    const double most = 2 * std::min(std::abs(a), std::abs(b));
    const double size = std::clamp(1.5 * std::abs(a) - 0.5 * std::abs(b), 0.0, most);
    return std::copysign(size, a);
}

Vec steady(const Vec &a, const Vec &b) {
    return {steady(a.x, b.x), steady(a.y, b.y), steady(a.z, b.z)};
}

} // namespace

// Its pose at one end and its velocities, masses and forces at the other.
void prefetch_body(const btRigidBody &body) {
    prefetch(body.getWorldTransform());
    prefetch(&body.getInvInertiaTensorWorld(), &body.getTotalTorque() + 1);
}

SolverBody free_body(const btRigidBody &body) {
    SolverBody out;
    out.velocity = three(body.getLinearVelocity());
    out.spin = three(body.getAngularVelocity());
    out.inverse_mass = static_cast<double>(body.getInvMass());
    const btMatrix3x3 &basis = body.getWorldTransform().getBasis();
    const btVector3 &inverse = body.getInvInertiaDiagLocal();
    const btVector3 root(std::sqrt(inverse.x()), std::sqrt(inverse.y()), std::sqrt(inverse.z()));
    out.inverse_inertia_root = along(basis, root);
    out.inertia_root = along(basis, btVector3(1 / root.x(), 1 / root.y(), 1 / root.z()));
    // The weight as Bullet rounds it (btRigidBody.cpp, setGravity, 3.24).
    const btVector3 weight = body.getGravity() * (btScalar(1) / body.getInvMass());
    out.acceleration = three(body.getTotalForce() + weight) * out.inverse_mass;
    out.spin_up = three(body.getInvInertiaTensorWorld() * body.getTotalTorque());
    return out;
}

Drive recalled_drive(const std::array<btTransform, 3> &ends, double step) {
    btVector3 velocity[2], spin[2]; // as NativeWorld::begin_drives has them
    for (int i = 0; i < 2; ++i) {
        btTransformUtil::calculateVelocity(ends[i], ends[i + 1], static_cast<btScalar>(step),
                                           velocity[i], spin[i]);
    }
    return {three(velocity[1]), three(spin[1]), three(velocity[1]) - three(velocity[0]),
            three(spin[1]) - three(spin[0])};
}

SolverBody kinematic_body(const btRigidBody &body, double step, Drive &drive) {
    SolverBody out;
    out.velocity = three(body.getLinearVelocity());
    out.spin = three(body.getAngularVelocity());
    const Vec change = out.velocity - drive.velocity;
    const Vec spin_change = out.spin - drive.spin;
    out.acceleration = steady(change, drive.change) * (1 / step);
    out.spin_up = steady(spin_change, drive.spin_change) * (1 / step);
    drive = {out.velocity, out.spin, change, spin_change};
    return out;
}

// Bullet moves a body by its velocity and turns it by its spin, for a step: they are given as what
// makes its displacement. A free body's spin changes while it turns; the spin it has half a step
// on, from the angular momentum it had on average, turns it right to the second order (midpoint
// rule).
void move_body(btRigidBody &body, const SolverBody &solved, double step, bool gyroscopic) {
    const double rate = 1 / step;
    const btVector3 inertia = moments(body);
    const bool uneven = gyroscopic && !even(inertia);
    btVector3 spin = vector(solved.turn * rate);
    btVector3 momentum(0, 0, 0); // at the end of the step, in world axes
    if (uneven) {
        const btMatrix3x3 &basis = body.getWorldTransform().getBasis();
        momentum = times(vector(solved.spin), inertia, basis);
        const btScalar half = static_cast<btScalar>(step / 2);
        spin = times(times(spin, inertia, basis), body.getInvInertiaDiagLocal(),
                     turned(basis, spin, half));
    }
    body.setLinearVelocity(vector(solved.shift * rate));
    body.setAngularVelocity(spin);
    // As Bullet does with a body that is not swept (btDiscreteDynamicsWorld.cpp,
    // integrateTransformsInternal, 3.24).
    btTransform end;
    body.predictIntegratedTransform(static_cast<btScalar>(step), end);
    const btScalar angle = spin.length() * static_cast<btScalar>(step);
    // It turns none further than that in a step (btTransformUtil.h, 3.24).
    if (angle > ANGULAR_MOTION_THRESHOLD) {
        end.setRotation((btQuaternion(spin, angle) * body.getOrientation()).normalized());
    }
    body.proceedToTransform(end);
    body.setLinearVelocity(vector(solved.velocity));
    body.setAngularVelocity(
        uneven ? times(momentum, body.getInvInertiaDiagLocal(), body.getWorldTransform().getBasis())
               : vector(solved.spin));
    body.clearForces();
}

void Press::hold(const btRigidBody &body) {
    const btVector3 arm = direction.cross(body.getWorldTransform().getOrigin() - about);
    const btScalar farthest = arm.length() + bounding_radius(*body.getCollisionShape());
    reach = std::max(reach, static_cast<double>(farthest));
}

double Press::gain(const btRigidBody &body, double step, bool goes_on) {
    const btVector3 &velocity = turns ? body.getAngularVelocity() : body.getLinearVelocity();
    const auto speed = static_cast<double>(direction.dot(velocity));
    const double unborne = known_ ? force - force_ : goes_on ? 0 : force;
    const double gain =
        inverse_mass * step * std::abs(unborne) + (known_ ? std::abs(speed - speed_) : 0);
    known_ = true;
    speed_ = speed;
    force_ = force;
    return gain * (turns ? reach : 1);
}

SolverBody pressed_body(const btRigidBody &body, const Press &press) {
    SolverBody out;
    const Vec direction = three(press.direction);
    // Velocity of the origin at unit speed, along the direction or about the axis.
    Vec unit = direction;
    double speed = direction.dot(three(body.getLinearVelocity()));
    const double root = std::sqrt(press.inverse_mass);
    const double faster = press.force * press.inverse_mass;
    if (press.turns) {
        unit = direction.cross(three(body.getWorldTransform().getOrigin() - press.about));
        speed = direction.dot(three(body.getAngularVelocity()));
        out.press_turn = direction * root;
        out.reach = press.reach;
        out.spin = direction * speed;
        out.spin_up = direction * faster;
    }
    out.press = unit * root;
    out.velocity = unit * speed;
    out.acceleration = unit * faster;
    return out;
}

void move_pressed(btRigidBody &body, const SolverBody &solved, const Press &press) {
    btTransform end = body.getWorldTransform();
    if (press.turns) {
        const btQuaternion turn(press.direction, press.direction.dot(vector(solved.turn)));
        end.setOrigin(press.about + quatRotate(turn, end.getOrigin() - press.about));
        end.setRotation((turn * end.getRotation()).normalized());
        const btVector3 spin = vector(solved.spin);
        body.setWorldTransform(end);
        body.setLinearVelocity(spin.cross(end.getOrigin() - press.about));
        body.setAngularVelocity(spin);
        return;
    }
    end.setOrigin(end.getOrigin() + vector(solved.shift));
    body.setWorldTransform(end);
    body.setLinearVelocity(vector(solved.velocity));
}

} // namespace pluvia
