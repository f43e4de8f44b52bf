#include "drives.h"

#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace pluvia {

namespace {

// Where a body would have been a step ago that goes on to `end` as it came.
btTransform a_step_ago(const btTransform &now, const btTransform &end) {
    btTransform before;
    before.setBasis(now.getBasis() * end.getBasis().transpose() * now.getBasis());
    before.setOrigin(now.getOrigin() * 2 - end.getOrigin());
    return before;
}

} // namespace

// As btRigidBody.cpp, saveKinematicState, 3.24.
DrivenVelocity driven_velocity(const btTransform &start, const btTransform &end, btScalar step) {
    DrivenVelocity out;
    btTransformUtil::calculateVelocity(a_step_ago(start, end), start, step, out.linear,
                                       out.angular);
    return out;
}

void Drives::remove(const btRigidBody *body) {
    drives_.erase(std::remove_if(drives_.begin(), drives_.end(),
                                 [body](const Drive &drive) { return drive.body == body; }),
                  drives_.end());
}

void Drives::begin_step() const {
    for (const Drive &drive : drives_) {
        drive.body->setInterpolationWorldTransform(
            a_step_ago(drive.body->getWorldTransform(), drive.end));
    }
}

void Drives::end_step() {
    for (const Drive &drive : drives_) {
        drive.body->setWorldTransform(drive.end);
        drive.body->setInterpolationWorldTransform(drive.end);
    }
    drives_.clear();
}

} // namespace pluvia
