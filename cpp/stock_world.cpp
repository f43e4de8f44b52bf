// The world with stock Bullet contacts: Bullet's own step, with its times measured and the pairs
// left out that cannot touch.
#include "stock_world.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

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

// Bullet has grown both boxes by the contact threshold already (btCollisionWorld::updateSingleAabb,
// 3.24): those of bodies within the threshold overlap by what one of them has grown, at least.
bool boxes_within_threshold(const btBroadphaseProxy &a, const btBroadphaseProxy &b) {
    const btScalar least = gContactBreakingThreshold;
    for (int axis = 0; axis < 3; ++axis) {
        if (a.m_aabbMax[axis] - b.m_aabbMin[axis] < least ||
            b.m_aabbMax[axis] - a.m_aabbMin[axis] < least) {
            return false;
        }
    }
    return true;
}

bool spheres_within_threshold(const btCollisionObject &a, const btCollisionObject &b) {
    const btScalar apart = bounding_radius(*a.getCollisionShape()) +
                           bounding_radius(*b.getCollisionShape()) + gContactBreakingThreshold;
    return (a.getWorldTransform().getOrigin() - b.getWorldTransform().getOrigin()).length2() <=
           apart * apart;
}

bool holds_contacts(btCollisionAlgorithm &algorithm) {
    // Kept for its memory: this runs for every pair of every step.
    thread_local btManifoldArray manifolds;
    manifolds.resize(0);
    algorithm.getAllContactManifolds(manifolds);
    for (int i = 0; i < manifolds.size(); ++i) {
        if (manifolds[i]->getNumContacts() > 0) {
            return true;
        }
    }
    return false;
}

// Bullet's near callback, preceded by two tests that are exact for what they leave out: boxes, then
// bounding spheres, further apart than the contact threshold. A pair that still holds contact
// points is never left out, since Bullet must refresh or drop them. What is left out cannot touch;
// but pairs meet the solver in another order then, so that a chaotic packing comes out as another
// pour does, not bit by bit as without these tests.
void near_callback(btBroadphasePair &pair, btCollisionDispatcher &dispatcher,
                   const btDispatcherInfo &info) {
    const btBroadphaseProxy &a = *pair.m_pProxy0;
    const btBroadphaseProxy &b = *pair.m_pProxy1;
    if ((boxes_within_threshold(a, b) &&
         spheres_within_threshold(*static_cast<const btCollisionObject *>(a.m_clientObject),
                                  *static_cast<const btCollisionObject *>(b.m_clientObject))) ||
        (pair.m_algorithm && holds_contacts(*pair.m_algorithm))) {
        btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    }
}

// A length in engine units without the last bits: worlds of grains of different sizes
// agree where only rounding differs.
btScalar shared_length(const Units &units, double metres) {
    int exponent = 0;
    const double mantissa = std::frexp(metres * units.scale(), &exponent);
    return static_cast<btScalar>(std::ldexp(std::round(std::ldexp(mantissa, 44)), exponent - 44));
}

// Bullet reads the same variable as a length or as a share of the radius.
btScalar contact_threshold(const Units &units, const WorldDefinition &d) {
    return d.relative_contact_threshold > 0 ? static_cast<btScalar>(d.relative_contact_threshold)
                                            : shared_length(units, d.contact_threshold);
}

} // namespace

StockParts::StockParts(const Units &units, const WorldDefinition &definition)
    : globals(contact_threshold(units, definition),
              shared_length(units, definition.broadphase_margin)) {
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
      units_(units), materials_(materials), definition_(definition) {
    auto &dispatch = getDispatchInfo();
    dispatch.m_useContinuous = false;
    dispatch.m_enableSatConvex = false;
    auto &info = getSolverInfo();
    info.m_numIterations = definition.iterations;
    info.m_solverMode = definition.solver_mode;
    info.m_erp = static_cast<btScalar>(definition.erp);
    info.m_erp2 = static_cast<btScalar>(definition.erp);
    info.m_warmstartingFactor = static_cast<btScalar>(definition.warm_start);
    info.m_splitImpulse = definition.split_impulse ? 1 : 0;
    // Bullet compares with an absolute length; scaled, it stays the 0.04
    // that it is for bodies of one metre.
    info.m_splitImpulsePenetrationThreshold = units.length(-0.04);
    info.m_restitutionVelocityThreshold = units.length(definition.restitution_velocity_threshold);
    info.m_linearSlop = 0;
    info.m_globalCfm = 0;
    info.m_frictionERP = 0;
    info.m_frictionCFM = 0;
    info.m_leastSquaresResidualThreshold = 0;
    info.m_sor = 1;
}

BodyDefinition StockWorld::applied(const BodyDefinition &definition,
                                   const btCollisionShape &shape) {
    BodyDefinition changed = definition;
    if (definition.kind != BodyKind::Free) {
        return changed;
    }
    changed.mass = std::max(definition.mass, definition_.least_mass);
    for (double &moment : changed.inertia) {
        moment *= changed.mass / definition.mass;
    }
    if (definition_.inertia == InertiaRule::Exact) {
        return changed;
    }
    const btVector3 boxed = boxed_inertia(
        shape, static_cast<btScalar>(changed.mass), units_.length(definition_.collision_margin),
        definition_.inertia == InertiaRule::BoundingBoxWithDefaultMargin);
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
    if (definition_.sleeping && kind == BodyKind::Kinematic) {
        body.forceActivationState(ISLAND_SLEEPING);
    } else if (definition_.sleeping && kind == BodyKind::Free) {
        body.forceActivationState(ACTIVE_TAG);
    }
    EngineWorld::add(body, kind);
}

void StockWorld::drive(btRigidBody &body, const btTransform &end) {
    if (definition_.sleeping) {
        const bool moves = !(end == body.getWorldTransform());
        body.forceActivationState(moves ? DISABLE_DEACTIVATION : ISLAND_SLEEPING);
        if (!moves) {
            // Asleep, Bullet would not take its velocity from its displacement any more.
            body.setLinearVelocity(btVector3(0, 0, 0));
            body.setAngularVelocity(btVector3(0, 0, 0));
        }
    }
    body.setWorldTransform(end);
}

void StockWorld::step(btScalar length) {
    const Stopwatch watch(phases_.integration);
    // No sub-steps: the step is the one that was asked for.
    stepSimulation(length, 0, length);
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
    const btContactSolverInfo &info = m_solverInfo;
    const btDispatcherInfo &dispatch = m_dispatchInfo;
    out.put("iterations", info.m_numIterations);
    out.put("solver_mode", info.m_solverMode);
    out.put("erp", info.m_erp);
    out.put("erp2", info.m_erp2);
    out.put("friction_erp", info.m_frictionERP);
    out.put("friction_cfm", info.m_frictionCFM);
    out.put("global_cfm", info.m_globalCfm);
    out.put("sor", info.m_sor);
    out.put("linear_slop_m", units_.metres(info.m_linearSlop));
    out.put("warm_starting_factor", info.m_warmstartingFactor);
    out.put("split_impulse", info.m_splitImpulse);
    out.put("split_impulse_penetration_threshold_m",
            units_.metres(info.m_splitImpulsePenetrationThreshold));
    out.put("split_impulse_turn_erp", info.m_splitImpulseTurnErp);
    out.put("restitution_velocity_threshold_m_per_s",
            units_.metres(info.m_restitutionVelocityThreshold));
    out.put("least_squares_residual_threshold", info.m_leastSquaresResidualThreshold);
    out.put("minimum_solver_batch_size", info.m_minimumSolverBatchSize);
    out.put("continuous_collision", dispatch.m_useContinuous);
    out.put("separating_axis_test_for_hulls", dispatch.m_enableSatConvex);
    out.put("speculative_contact_restitution", getApplySpeculativeContactRestitution());
    const bool relative = (dispatcher.getDispatcherFlags() &
                           btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD) != 0;
    out.put("contact_breaking_threshold_m", units_.metres(gContactBreakingThreshold));
    out.put("relative_contact_threshold",
            relative ? static_cast<double>(gContactBreakingThreshold) : 0);
    out.put("broadphase_margin_m", units_.metres(gDbvtMargin));
}

void StockWorld::read_body(const btRigidBody &body, ReadBack &out) const {
    out.put("rigid_body_flags", body.getFlags());
    out.put("activation_state", body.getActivationState());
    out.put("sleeping_speed_m_per_s", units_.metres(body.getLinearSleepingThreshold()));
    out.put("sleeping_spin_rad_per_s", body.getAngularSleepingThreshold());
    out.put("sleeping_time_s", gDeactivationTime);
}

void StockWorld::performDiscreteCollisionDetection() {
    const Stopwatch watch(phases_.collision, &phases_.integration);
    EngineWorld::performDiscreteCollisionDetection();
}

void StockWorld::updateAabbs() {
    const Stopwatch watch(phases_.broadphase, &phases_.collision);
    EngineWorld::updateAabbs();
}

void StockWorld::computeOverlappingPairs() {
    const Stopwatch watch(phases_.broadphase, &phases_.collision);
    EngineWorld::computeOverlappingPairs();
}

void StockWorld::solveConstraints(btContactSolverInfo &info) {
    const Stopwatch watch(phases_.solver, &phases_.integration);
    EngineWorld::solveConstraints(info);
}

} // namespace pluvia
