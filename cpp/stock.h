// What Bullet's own contact path does to a body beside what every path does:
// sleep, moments of inertia of bounding boxes, a least mass. And its contacts.
#pragma once

#include "bodies.h"
#include "convert.h"
#include "shapes.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace pluvia {

class StockRules {
  public:
    StockRules(const Units &units, const WorldDefinition &definition);

    // The definition with the mass and the moments of inertia that the rules
    // make of it; both are left alone where no rule changes them.
    BodyDefinition applied(const Units &units, const BodyDefinition &definition,
                           const TightHull &shape);

    // Lets a body fall asleep where that is asked for. A driven one that stands
    // still is asleep from the beginning: awake, it would keep all awake that touch it.
    void let_sleep(btRigidBody &body) const;

    // Says where a driven body is at the end of the next step. It wakes when it
    // moves, and sleeps again when it is driven to where it is.
    void drive(btRigidBody &body, const btTransform &pose) const;

    // Largest ratio of the moments of inertia given to a free body to the exact
    // ones of the mass that it was given.
    double largest_inertia_ratio() const { return largest_inertia_ratio_; }

  private:
    double least_mass_;
    InertiaRule inertia_;
    btScalar margin_;
    bool deactivation_;
    btScalar speed_;
    btScalar spin_;
    double largest_inertia_ratio_ = 1;
};

// Adds Bullet's own contact points.
void read_manifolds(const Units &units, const btCollisionDispatcher &dispatcher,
                    rust::Vec<ContactRead> &out);

} // namespace pluvia
