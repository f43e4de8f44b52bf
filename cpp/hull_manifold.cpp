#include "hull_manifold.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>

namespace pluvia {

namespace {

// Cosine of the angle between old and new normal from which impulses go on as they are.
constexpr double SAME_NORMAL = 0.99;

btVector3 vector(const double x[3]) {
    return btVector3(static_cast<btScalar>(x[0]), static_cast<btScalar>(x[1]),
                     static_cast<btScalar>(x[2]));
}

// The manifold has no room for a second pool of points: four are copied out.
struct Old {
    btVector3 on_a, on_b, normal;
    btScalar impulse, lateral_1, lateral_2;
    btVector3 direction_1, direction_2;
    int id, age;
    bool free;
};

void carry_over(const Old &old, btManifoldPoint &point) {
    point.m_lifeTime = old.age + 1;
    const auto cosine = static_cast<double>(old.normal.dot(point.m_normalWorldOnB));
    if (cosine >= SAME_NORMAL) {
        point.m_appliedImpulse = old.impulse;
        point.m_appliedImpulseLateral1 = old.lateral_1;
        point.m_appliedImpulseLateral2 = old.lateral_2;
        point.m_lateralFrictionDir1 = old.direction_1;
        point.m_lateralFrictionDir2 = old.direction_2;
        return;
    }
    const btVector3 whole = old.normal * old.impulse + old.direction_1 * old.lateral_1 +
                            old.direction_2 * old.lateral_2;
    const btScalar along = whole.dot(point.m_normalWorldOnB);
    if (along <= 0) {
        return;
    }
    const btVector3 rest = whole - point.m_normalWorldOnB * along;
    const btScalar size = rest.length();
    point.m_appliedImpulse = along;
    if (size > 0) {
        point.m_lateralFrictionDir1 = rest / size;
        point.m_lateralFrictionDir2 = point.m_normalWorldOnB.cross(point.m_lateralFrictionDir1);
        point.m_appliedImpulseLateral1 = size;
    }
}

} // namespace

int held_ids(const btPersistentManifold &manifold, std::uint32_t ids[4]) {
    const int count = manifold.getNumContacts();
    for (int i = 0; i < count; ++i) {
        ids[i] = static_cast<std::uint32_t>(manifold.getContactPoint(i).m_index0);
    }
    return count;
}

void write_manifold(const PairContact &contact, const btTransform &pose_a,
                    const btTransform &pose_b, btScalar match, btPersistentManifold &manifold) {
    Old old[4];
    const int held = manifold.getNumContacts();
    for (int i = 0; i < held; ++i) {
        const btManifoldPoint &p = manifold.getContactPoint(i);
        old[i] = {p.m_localPointA,
                  p.m_localPointB,
                  p.m_normalWorldOnB,
                  p.m_appliedImpulse,
                  p.m_appliedImpulseLateral1,
                  p.m_appliedImpulseLateral2,
                  p.m_lateralFrictionDir1,
                  p.m_lateralFrictionDir2,
                  p.m_index0,
                  p.m_lifeTime,
                  true};
    }
    btManifoldPoint fresh[4];
    bool matched[4] = {false, false, false, false};
    const btVector3 normal = -vector(contact.normal);
    for (int i = 0; i < contact.count; ++i) {
        const PairPoint &from = contact.points[i];
        fresh[i] = btManifoldPoint(vector(from.on_a), vector(from.on_b), normal,
                                   static_cast<btScalar>(from.gap));
        btManifoldPoint &point = fresh[i];
        point.m_positionWorldOnA = pose_a(point.m_localPointA);
        point.m_positionWorldOnB = pose_b(point.m_localPointB);
        point.m_index0 = static_cast<int>(from.id);
        for (int k = 0; k < held && !matched[i]; ++k) {
            if (old[k].free && old[k].id == point.m_index0) {
                carry_over(old[k], point);
                old[k].free = false;
                matched[i] = true;
            }
        }
    }
    // What is left: nearest first, so that the result does not hang on the order.
    for (;;) {
        btScalar nearest = match * match;
        int new_point = -1;
        int old_point = -1;
        for (int i = 0; i < contact.count; ++i) {
            for (int k = 0; k < held; ++k) {
                if (matched[i] || !old[k].free) {
                    continue;
                }
                const btScalar distance = std::min(old[k].on_a.distance2(fresh[i].m_localPointA),
                                                   old[k].on_b.distance2(fresh[i].m_localPointB));
                if (distance < nearest) {
                    nearest = distance;
                    new_point = i;
                    old_point = k;
                }
            }
        }
        if (new_point < 0) {
            break;
        }
        carry_over(old[old_point], fresh[new_point]);
        old[old_point].free = false;
        matched[new_point] = true;
    }
    const btCollisionObject *body_a = manifold.getBody0();
    const btCollisionObject *body_b = manifold.getBody1();
    const btScalar friction = gCalculateCombinedFrictionCallback(body_a, body_b);
    const btScalar restitution = gCalculateCombinedRestitutionCallback(body_a, body_b);
    manifold.setNumContacts(contact.count);
    for (int i = 0; i < contact.count; ++i) {
        fresh[i].m_combinedFriction = friction;
        fresh[i].m_combinedRestitution = restitution;
        manifold.getContactPoint(i) = fresh[i];
    }
}

} // namespace pluvia
