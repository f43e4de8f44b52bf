#include "hull_world.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace pluvia {

namespace {

bool holds(const btBroadphaseProxy &proxy, const HullRange &range) {
    for (int i = 0; i < 3; ++i) {
        if (static_cast<btScalar>(range.low[i]) < proxy.m_aabbMin[i] ||
            static_cast<btScalar>(range.high[i]) > proxy.m_aabbMax[i]) {
            return false;
        }
    }
    return true;
}

btVector3 vector(const float x[3]) {
    return btVector3(static_cast<btScalar>(x[0]), static_cast<btScalar>(x[1]),
                     static_cast<btScalar>(x[2]));
}

} // namespace

btVector3 HullWorld::place() const {
    return followed_ == nullptr ? start_ : start_ + followed_->getWorldTransform().getOrigin();
}

void HullWorld::follow(const btRigidBody *body) {
    // The place does not jump: all boxes would have to be renewed.
    const btVector3 now = place();
    followed_ = body;
    start_ += now - place();
}

void HullWorld::renew_boxes() {
    Frame frame;
    const btVector3 origin = place();
    for (int i = 0; i < 3; ++i) {
        frame.origin[i] = static_cast<double>(origin[i]);
        frame.velocity[i] =
            followed_ == nullptr ? 0 : static_cast<double>(followed_->getLinearVelocity()[i]);
    }
    const btVector3 slack(slack_, slack_, slack_);
    const btCollisionObjectArray &objects = getCollisionObjectArray();
    collision_.bodies.begin(frame, objects, collision_.step, collision_.settings.reach);
    // One after the other, each body would be paired with those that have not
    // got their new boxes yet, though all fall alike.
    boxes_.m_deferedcollide = collision_.bodies.crowded();
    for (int i = 0; i < objects.size(); ++i) {
        const HullRange &range = collision_.bodies.take(objects, i, *collision_.kernels);
        btBroadphaseProxy *proxy = objects[i]->getBroadphaseHandle();
        if (!holds(*proxy, range)) {
            boxes_.setAabb(proxy, vector(range.low) - slack, vector(range.high) + slack,
                           getDispatcher());
        }
    }
}

void HullWorld::addRigidBody(btRigidBody *body, int group, int mask) {
    PhasedWorld::addRigidBody(body, group, mask);
    solver_.bodies_changed();
}

void HullWorld::removeRigidBody(btRigidBody *body) {
    PhasedWorld::removeRigidBody(body);
    solver_.bodies_changed();
}

// Comes first in a step. Bullet looks through all bodies for those that are driven.
void HullWorld::saveKinematicState(btScalar step) {
    solver_.sort_bodies(getCollisionObjectArray());
    for (btRigidBody *body : solver_.driven()) {
        body->saveKinematicState(step);
    }
}

void HullWorld::integrateTransforms(btScalar step) {
    solver_.move_bodies(static_cast<double>(step));
}

// Bullet also predicts where bodies will be, for motion states and sweeps.
void HullWorld::predictUnconstraintMotion(btScalar step) {
    if (!damped_) {
        return;
    }
    for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
        if (!m_nonStaticRigidBodies[i]->isStaticOrKinematicObject()) {
            m_nonStaticRigidBodies[i]->applyDamping(step);
        }
    }
}

void HullWorld::solve(btContactSolverInfo &info) {
    btCollisionObjectArray &objects = getCollisionObjectArray();
    if (objects.size() == 0) {
        return;
    }
    getConstraintSolver()->solveGroup(&objects[0], objects.size(), nullptr, 0, nullptr, 0, info,
                                      getDebugDrawer(), getDispatcher());
}

} // namespace pluvia
