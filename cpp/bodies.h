// Rigid bodies: free, driven (kinematic) and static, and the friction and
// restitution of each pair of materials.
#pragma once

#include "convert.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "pool.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace pluvia {

// Friction and restitution by material, row by row.
struct Materials {
    std::size_t count;
    std::vector<PairValue> pairs; // count squared

    const PairValue &of(const btCollisionObject &a, const btCollisionObject &b) const;
};

// Collision groups: walls of every kind never meet each other.
enum Group : int { FREE = 1, WALL = 2 };

struct DampingAndSpin {
    btScalar linear;
    btScalar angular;
    bool gyroscopic;
};

// Gives a body's room back to its pool.
struct BodyEnd {
    Pool *pool;
    void operator()(btRigidBody *body) const {
        body->~btRigidBody();
        pool->give_back(body);
    }
};
using BodyPtr = std::unique_ptr<btRigidBody, BodyEnd>;

// A body as defined, in a piece of `pool`; `id` and its material are found again in Bullet's user
// indices, the materials' table behind its user pointer.
BodyPtr make_body(const Units &units, const BodyDefinition &definition, int id,
                  btConvexHullShape *shape, Materials *materials, const DampingAndSpin &settings,
                  Pool &pool);

// Bullet's hooks for the coefficients of a pair (btManifoldResult.h). They
// stand in for Bullet's rule, which multiplies one value of each body.
btScalar combined_friction(const btCollisionObject *a, const btCollisionObject *b);
btScalar combined_restitution(const btCollisionObject *a, const btCollisionObject *b);

} // namespace pluvia
