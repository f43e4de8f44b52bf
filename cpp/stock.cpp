#include "stock.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <algorithm>

namespace pluvia {

namespace {

// Bullet's own moments of inertia for a hull, by the calls that a program makes
// which leaves them to Bullet. Whether the margin is set before or after the
// shape stores its box decides what the box holds (btPolyhedralConvexShape.cpp,
// 3.24).
btVector3 boxed_inertia(const TightHull &hull, btScalar mass, btScalar margin, bool stale) {
    btConvexHullShape shape;
    if (!stale) {
        shape.setMargin(margin);
    }
    for (int i = 0; i < hull.getNumPoints(); ++i) {
        shape.addPoint(hull.getUnscaledPoints()[i], false);
    }
    shape.recalcLocalAabb();
    shape.setMargin(margin);
    btVector3 inertia(0, 0, 0);
    shape.calculateLocalInertia(mass, inertia);
    return inertia;
}

} // namespace

StockRules::StockRules(const Units &units, const WorldDefinition &definition)
    : least_mass_(definition.least_mass), inertia_(definition.inertia),
      margin_(units.length(definition.collision_margin)), deactivation_(definition.deactivation),
      speed_(units.length(definition.deactivation_speed)),
      spin_(static_cast<btScalar>(definition.deactivation_spin)) {}

BodyDefinition StockRules::applied(const Units &units, const BodyDefinition &definition,
                                   const TightHull &shape) {
    BodyDefinition changed = definition;
    if (definition.kind != BodyKind::Free) {
        return changed;
    }
    changed.mass = std::max(definition.mass, least_mass_);
    for (double &moment : changed.inertia) {
        moment *= changed.mass / definition.mass;
    }
    if (inertia_ == InertiaRule::Exact) {
        return changed;
    }
    const btVector3 boxed = boxed_inertia(shape, static_cast<btScalar>(changed.mass), margin_,
                                          inertia_ == InertiaRule::BoundingBoxWithDefaultMargin);
    const double area = units.scale() * units.scale();
    for (std::size_t i = 0; i < 3; ++i) {
        const double moment = static_cast<double>(boxed[static_cast<int>(i)]) / area;
        largest_inertia_ratio_ = std::max(largest_inertia_ratio_, moment / changed.inertia[i]);
        changed.inertia[i] = moment;
    }
    return changed;
}

void StockRules::let_sleep(btRigidBody &body) const {
    body.setSleepingThresholds(speed_, spin_);
    if (!deactivation_) {
        return;
    }
    // A kinematic body without mass carries the flag of static ones, too.
    if (body.isKinematicObject()) {
        body.forceActivationState(ISLAND_SLEEPING);
    } else if (!body.isStaticObject()) {
        body.forceActivationState(ACTIVE_TAG);
    }
}

void StockRules::drive(btRigidBody &body, const btTransform &pose) const {
    if (deactivation_) {
        const bool moves = !(pose == body.getWorldTransform());
        body.forceActivationState(moves ? DISABLE_DEACTIVATION : ISLAND_SLEEPING);
        if (!moves) {
            // Asleep, Bullet would not take its velocity from its way any more.
            body.setLinearVelocity(btVector3(0, 0, 0));
            body.setAngularVelocity(btVector3(0, 0, 0));
        }
    }
    body.setWorldTransform(pose);
}

void read_manifolds(const Units &units, const btCollisionDispatcher &dispatcher,
                    rust::Vec<ContactRead> &out) {
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
        const btPersistentManifold *manifold =
            const_cast<btCollisionDispatcher &>(dispatcher).getManifoldByIndexInternal(m);
        for (int p = 0; p < manifold->getNumContacts(); ++p) {
            const btManifoldPoint &point = manifold->getContactPoint(p);
            const btVector3 middle =
                (point.getPositionWorldOnA() + point.getPositionWorldOnB()) * btScalar(0.5);
            ContactRead read{};
            read.a = static_cast<std::uint32_t>(manifold->getBody0()->getUserIndex());
            read.b = static_cast<std::uint32_t>(manifold->getBody1()->getUserIndex());
            read.point = units.metres(middle);
            read.normal = array(point.m_normalWorldOnB);
            read.gap = units.metres(point.getDistance());
            read.impulse =
                units.metres(point.m_normalWorldOnB * point.m_appliedImpulse +
                             point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                             point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2);
            out.push_back(read);
        }
    }
}

} // namespace pluvia
