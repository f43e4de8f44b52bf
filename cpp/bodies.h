// Rigid bodies: free, kinematic and static, and the friction and
// restitution of each pair of materials.
#pragma once

#include "convert.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "pool.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace pluvia {

// Friction and restitution by material, row by row, and the material of each body.
struct Materials {
    std::size_t count;
    std::vector<PairValue> pairs;    // count squared
    std::vector<std::size_t> bodies; // by the body's number

    const PairValue &of(int a, int b) const;
};

// Collision groups: walls of every kind never meet each other.
enum Group : int { FREE = 1, WALL = 2 };

// Gives a body's room back to its pool.
struct BodyEnd {
    Pool *pool;
    void operator()(btRigidBody *body) const {
        body->~btRigidBody();
        pool->give_back(body);
    }
};
using BodyPtr = std::unique_ptr<btRigidBody, BodyEnd>;

// A body as defined, in a piece of `pool`; Bullet's user index holds its number.
BodyPtr make_body(const Units &units, const WorldDefinition &world,
                  const BodyDefinition &definition, int id, btCollisionShape *shape, Pool &pool);

} // namespace pluvia
