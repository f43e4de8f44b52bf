// Makes Bullet's rigid bodies from their definitions, and looks up the friction and restitution of
// a pair of materials.
#include "bodies.h"

namespace pluvia {

const PairValue &Materials::of(int a, int b) const {
    const auto material = [this](int body) { return bodies[body]; };
    return pairs[material(a) * count + material(b)];
}

BodyPtr make_body(const Units &units, const WorldDefinition &world,
                  const BodyDefinition &definition, int id, btCollisionShape *shape, Pool &pool) {
    const bool free = definition.kind == BodyKind::Free;
    const btScalar mass = free ? static_cast<btScalar>(definition.mass) : btScalar(0);
    const btVector3 inertia = free ? units.inertia(definition.inertia) : btVector3(0, 0, 0);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = units.pose(definition);
    info.m_linearDamping = static_cast<btScalar>(world.linear_damping);
    info.m_angularDamping = static_cast<btScalar>(world.angular_damping);
    info.m_additionalDamping = false;
    // The hooks for pairs (globals.cpp) do not read these; with 1, Bullet's product is 1 as well.
    info.m_friction = 1;
    info.m_restitution = 1;
    info.m_rollingFriction = 0;
    info.m_spinningFriction = 0;
    BodyPtr body(new (pool.take()) btRigidBody(info), BodyEnd{&pool});
    if (free) {
        body->setFlags(world.gyroscopic ? BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY : 0);
        body->setLinearVelocity(units.length(definition.linear_velocity));
        body->setAngularVelocity(vector(three(definition.angular_velocity.data())));
    }
    if (definition.kind == BodyKind::Kinematic) {
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    }
    if (definition.kind != BodyKind::Static) {
        body->setActivationState(DISABLE_DEACTIVATION);
    }
    body->setUserIndex(id);
    body->setSleepingThresholds(units.length(world.sleeping_speed),
                                static_cast<btScalar>(world.sleeping_spin));
    return body;
}

} // namespace pluvia
