#include "stock_world.h"

#include "pairs.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <algorithm>

namespace pluvia {

namespace {

btDefaultCollisionConstructionInfo pool_sizes() {
    // Bullet falls back to the heap when a pool is full, which is slow. A
    // dense specimen of 1456 grains holds about 20 000 pairs.
    constexpr int PAIRS = 32768;
    btDefaultCollisionConstructionInfo info;
    info.m_defaultMaxPersistentManifoldPoolSize = PAIRS;
    info.m_defaultMaxCollisionAlgorithmPoolSize = PAIRS;
    return info;
}

// Bullet's own moments of inertia for a hull, by the calls that a program makes
// which leaves them to Bullet. Whether the margin is set before or after the
// shape stores its box decides what the box holds (btPolyhedralConvexShape.cpp,
// 3.24). Those of a sphere are exact.
btVector3 boxed_inertia(const btCollisionShape &original, btScalar mass, btScalar margin,
                        bool stale) {
    btVector3 inertia(0, 0, 0);
    if (original.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
        original.calculateLocalInertia(mass, inertia);
        return inertia;
    }
    const auto &hull = static_cast<const TightHull &>(original);
    btConvexHullShape shape;
    // Of a rounded one the margin is the shape itself.
    if (hull.data().is_rounded()) {
        margin = hull.getMargin();
        stale = false;
    }
    if (!stale) {
        shape.setMargin(margin);
    }
    for (int i = 0; i < hull.getNumPoints(); ++i) {
        shape.addPoint(hull.getUnscaledPoints()[i], false);
    }
    shape.recalcLocalAabb();
    shape.setMargin(margin);
    shape.calculateLocalInertia(mass, inertia);
    return inertia;
}

} // namespace

StockParts::StockParts(const Units &units, const WorldDefinition &definition)
    : globals(global_settings(units, definition)), configuration(pool_sizes()),
      dispatcher(&configuration) {
    // A relative threshold destroys manifolds: used only where it is asked for.
    const int relative = btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD;
    const int flags = dispatcher.getDispatcherFlags() & ~relative;
    if (definition.relative_contact_threshold > 0) {
        dispatcher.setDispatcherFlags(flags | relative);
    } else {
        dispatcher.setDispatcherFlags(flags);
        // Leaves out what is further apart than the absolute one.
        dispatcher.setNearCallback(&near_callback);
    }
}

StockWorld::StockWorld(const Units &units, const WorldDefinition &definition, Materials &materials)
    : StockParts(units, definition), EngineWorld(&dispatcher, &boxes, &solver, &configuration),
      units_(units), materials_(materials), least_mass_(definition.least_mass),
      inertia_(definition.inertia), margin_(units.length(definition.collision_margin)),
      sleeping_(definition.sleeping) {}

BodyDefinition StockWorld::applied(const BodyDefinition &definition,
                                   const btCollisionShape &shape) {
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
    const double area = units_.scale() * units_.scale();
    for (std::size_t i = 0; i < 3; ++i) {
        const double moment = static_cast<double>(boxed[static_cast<int>(i)]) / area;
        largest_inertia_ratio_ = std::max(largest_inertia_ratio_, moment / changed.inertia[i]);
        changed.inertia[i] = moment;
    }
    return changed;
}

void StockWorld::add(btRigidBody &body, BodyKind kind) {
    body.setUserPointer(&materials_);
    // A kinematic body without mass carries the flag of static ones, too.
    if (sleeping_ && kind == BodyKind::Kinematic) {
        body.forceActivationState(ISLAND_SLEEPING);
    } else if (sleeping_ && kind == BodyKind::Free) {
        body.forceActivationState(ACTIVE_TAG);
    }
    EngineWorld::add(body, kind);
}

void StockWorld::drive(btRigidBody &body, const btTransform &end) {
    if (sleeping_) {
        const bool moves = !(end == body.getWorldTransform());
        body.forceActivationState(moves ? DISABLE_DEACTIVATION : ISLAND_SLEEPING);
        if (!moves) {
            // Asleep, Bullet would not take its velocity from its way any more.
            body.setLinearVelocity(btVector3(0, 0, 0));
            body.setAngularVelocity(btVector3(0, 0, 0));
        }
    }
    body.setWorldTransform(end);
}

void StockWorld::step(btScalar length) {
    double outside = 0;
    const Stopwatch watch(phases_.integration, outside);
    // No sub-steps: the step is the one that was asked for.
    stepSimulation(length, 0, length);
}

void StockWorld::find_contacts() {
    double outside = 0;
    const Stopwatch watch(phases_.integration, outside);
    performDiscreteCollisionDetection();
}

void StockWorld::read_contacts(rust::Vec<ContactRead> &out) const {
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
            read.point = units_.metres(middle);
            read.normal = array(point.m_normalWorldOnB);
            read.gap = units_.metres(point.getDistance());
            read.impulse =
                units_.metres(point.m_normalWorldOnB * point.m_appliedImpulse +
                              point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                              point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2);
            out.push_back(read);
        }
    }
}

PairValue StockWorld::pair_value(const btRigidBody &a, const btRigidBody &b) const {
    return {static_cast<double>(gCalculateCombinedFrictionCallback(&a, &b)),
            static_cast<double>(gCalculateCombinedRestitutionCallback(&a, &b))};
}

void StockWorld::read_settings(ReadBack &out) const {
    const GlobalSettings held = GlobalsHold::read_back();
    const bool relative = (dispatcher.getDispatcherFlags() &
                           btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD) != 0;
    out.put("contact_breaking_threshold_m", units_.metres(held.contact_breaking_threshold));
    out.put("relative_contact_threshold",
            relative ? static_cast<double>(held.contact_breaking_threshold) : 0);
    out.put("broadphase_margin_m", units_.metres(held.broadphase_margin));
}

void StockWorld::performDiscreteCollisionDetection() {
    const Stopwatch watch(phases_.collision, phases_.integration);
    EngineWorld::performDiscreteCollisionDetection();
}

void StockWorld::updateAabbs() {
    const Stopwatch watch(phases_.broadphase, phases_.collision);
    EngineWorld::updateAabbs();
}

void StockWorld::computeOverlappingPairs() {
    const Stopwatch watch(phases_.broadphase, phases_.collision);
    EngineWorld::computeOverlappingPairs();
}

void StockWorld::solveConstraints(btContactSolverInfo &info) {
    const Stopwatch watch(phases_.solver, phases_.integration);
    EngineWorld::solveConstraints(info);
}

} // namespace pluvia
