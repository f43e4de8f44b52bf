#include "drives.h"

#include <algorithm>

namespace pluvia {

void Drives::remove(const btRigidBody *body) {
    drives_.erase(std::remove_if(drives_.begin(), drives_.end(),
                                 [body](const Drive &drive) { return drive.body == body; }),
                  drives_.end());
}

void Drives::begin_step() const {
    for (const Drive &drive : drives_) {
        const btTransform &now = drive.body->getWorldTransform();
        btTransform before;
        before.setBasis(now.getBasis() * drive.end.getBasis().transpose() * now.getBasis());
        before.setOrigin(now.getOrigin() * 2 - drive.end.getOrigin());
        drive.body->setInterpolationWorldTransform(before);
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
