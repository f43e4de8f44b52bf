#include "bodies.h"

namespace pluvia {

const PairValue &Materials::of(const btCollisionObject &a, const btCollisionObject &b) const {
    return pairs[static_cast<std::size_t>(a.getUserIndex2()) * count +
                 static_cast<std::size_t>(b.getUserIndex2())];
}

BodyPtr make_body(const Units &units, const BodyDefinition &definition, int id,
                  btConvexHullShape *shape, Materials *materials, const DampingAndSpin &settings,
                  Pool &pool) {
    const bool free = definition.kind == BodyKind::Free;
    const btScalar mass = free ? static_cast<btScalar>(definition.mass) : btScalar(0);
    const btVector3 inertia = free ? units.inertia(definition.inertia) : btVector3(0, 0, 0);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = units.pose(definition.position, definition.rotation);
    info.m_linearDamping = settings.linear;
    info.m_angularDamping = settings.angular;
    info.m_additionalDamping = false;
    // Unused by the pair hooks below; one keeps Bullet's own product neutral.
    info.m_friction = 1;
    info.m_restitution = 1;
    info.m_rollingFriction = 0;
    info.m_spinningFriction = 0;
    BodyPtr body(new (pool.take()) btRigidBody(info), BodyEnd{&pool});
    if (free) {
        body->setFlags(settings.gyroscopic ? BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY : 0);
        body->setLinearVelocity(units.length(definition.linear_velocity));
        body->setAngularVelocity(vector(definition.angular_velocity));
    }
    if (definition.kind == BodyKind::Driven) {
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    }
    if (definition.kind != BodyKind::Static) {
        body->setActivationState(DISABLE_DEACTIVATION);
    }
    body->setUserIndex(id);
    body->setUserIndex2(static_cast<int>(definition.material));
    body->setUserPointer(materials);
    return body;
}

namespace {
const PairValue &pair_value(const btCollisionObject *a, const btCollisionObject *b) {
    return static_cast<const Materials *>(a->getUserPointer())->of(*a, *b);
}
} // namespace

btScalar combined_friction(const btCollisionObject *a, const btCollisionObject *b) {
    return static_cast<btScalar>(pair_value(a, b).friction);
}

btScalar combined_restitution(const btCollisionObject *a, const btCollisionObject *b) {
    return static_cast<btScalar>(pair_value(a, b).restitution);
}

} // namespace pluvia
