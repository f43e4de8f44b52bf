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

// What a point hands on.
struct Heritage {
    btScalar impulse = 0, lateral_1 = 0, lateral_2 = 0;
    btVector3 direction_1{0, 0, 0}, direction_2{0, 0, 0};
    btScalar arrival = 0; // the solver's, in m_contactMotion1
    int age = 0;
};

Heritage heritage(const btManifoldPoint &old, const btVector3 &normal) {
    Heritage out;
    out.age = old.m_lifeTime + 1;
    out.arrival = old.m_contactMotion1;
    if (static_cast<double>(old.m_normalWorldOnB.dot(normal)) >= SAME_NORMAL) {
        out.impulse = old.m_appliedImpulse;
        out.lateral_1 = old.m_appliedImpulseLateral1;
        out.lateral_2 = old.m_appliedImpulseLateral2;
        out.direction_1 = old.m_lateralFrictionDir1;
        out.direction_2 = old.m_lateralFrictionDir2;
        return out;
    }
    const btVector3 whole = old.m_normalWorldOnB * old.m_appliedImpulse +
                            old.m_lateralFrictionDir1 * old.m_appliedImpulseLateral1 +
                            old.m_lateralFrictionDir2 * old.m_appliedImpulseLateral2;
    const btScalar along = whole.dot(normal);
    if (along > 0) {
        const btVector3 rest = whole - normal * along;
        const btScalar size = rest.length();
        out.impulse = along;
        if (size > 0) {
            out.direction_1 = rest / size;
            out.direction_2 = normal.cross(out.direction_1);
            out.lateral_1 = size;
        }
    }
    return out;
}

// For each new point the old one that it continues, or -1.
void match_points(const PairContact &contact, const btPersistentManifold &manifold, btScalar match,
                  int from[4]) {
    const int held = manifold.getNumContacts();
    bool taken[4] = {false, false, false, false};
    int left = 0;
    for (int i = 0; i < contact.count; ++i) {
        from[i] = -1;
        for (int k = 0; k < held && from[i] < 0; ++k) {
            if (!taken[k] &&
                manifold.getContactPoint(k).m_index0 == static_cast<int>(contact.points[i].id)) {
                from[i] = k;
                taken[k] = true;
            }
        }
        left += from[i] < 0;
    }
    // What is left: nearest first, so that the result does not hang on the order.
    while (left > 0) {
        btScalar nearest = match * match;
        int new_point = -1;
        int old_point = -1;
        for (int i = 0; i < contact.count; ++i) {
            for (int k = 0; k < held; ++k) {
                if (from[i] >= 0 || taken[k]) {
                    continue;
                }
                const btManifoldPoint &old = manifold.getContactPoint(k);
                const btScalar distance =
                    std::min(old.m_localPointA.distance2(vector(contact.points[i].on_a)),
                             old.m_localPointB.distance2(vector(contact.points[i].on_b)));
                if (distance < nearest) {
                    nearest = distance;
                    new_point = i;
                    old_point = k;
                }
            }
        }
        if (new_point < 0) {
            return;
        }
        from[new_point] = old_point;
        taken[old_point] = true;
        --left;
    }
}

// Where each new point goes: to the place of the old one if there is room.
void assign_places(const int from[4], int count, int place[4]) {
    bool used[4] = {false, false, false, false};
    for (int i = 0; i < count; ++i) {
        place[i] = from[i] >= 0 && from[i] < count ? from[i] : -1;
        if (place[i] >= 0) {
            used[place[i]] = true;
        }
    }
    int next = 0;
    for (int i = 0; i < count; ++i) {
        if (place[i] < 0) {
            while (used[next]) {
                ++next;
            }
            place[i] = next;
            used[next] = true;
        }
    }
}

} // namespace

namespace {

void set_place(const PairPoint &from, const btVector3 &normal, const btTransform &pose_a,
               const btTransform &pose_b, btManifoldPoint &point) {
    point.m_localPointA = vector(from.on_a);
    point.m_localPointB = vector(from.on_b);
    point.m_positionWorldOnA = pose_a(point.m_localPointA);
    point.m_positionWorldOnB = pose_b(point.m_localPointB);
    point.m_normalWorldOnB = normal;
    point.m_distance1 = static_cast<btScalar>(from.gap);
}

} // namespace

void refresh_manifold(const PairContact &contact, const btTransform &pose_a,
                      const btTransform &pose_b, btPersistentManifold &manifold) {
    const btVector3 normal = -vector(contact.normal);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
        btManifoldPoint &point = manifold.getContactPoint(k);
        for (int i = 0; i < contact.count; ++i) {
            if (point.m_index0 == static_cast<int>(contact.points[i].id)) {
                set_place(contact.points[i], normal, pose_a, pose_b, point);
                ++point.m_lifeTime;
                break;
            }
        }
    }
}

void write_manifold(const PairContact &contact, const btTransform &pose_a,
                    const btTransform &pose_b, btScalar match, btPersistentManifold &manifold) {
    int from[4];
    int place[4];
    match_points(contact, manifold, match, from);
    assign_places(from, contact.count, place);
    const btVector3 normal = -vector(contact.normal);
    // All of it before the first point is overwritten.
    Heritage heritages[4];
    for (int i = 0; i < contact.count; ++i) {
        if (from[i] >= 0) {
            heritages[i] = heritage(manifold.getContactPoint(from[i]), normal);
        }
    }
    const btCollisionObject *body_a = manifold.getBody0();
    const btCollisionObject *body_b = manifold.getBody1();
    const btScalar friction = gCalculateCombinedFrictionCallback(body_a, body_b);
    const btScalar restitution = gCalculateCombinedRestitutionCallback(body_a, body_b);
    manifold.setNumContacts(contact.count);
    for (int i = 0; i < contact.count; ++i) {
        btManifoldPoint &point = manifold.getContactPoint(place[i]);
        if (place[i] != from[i]) {
            point = btManifoldPoint(btVector3(0, 0, 0), btVector3(0, 0, 0), normal, 0);
        }
        set_place(contact.points[i], normal, pose_a, pose_b, point);
        point.m_index0 = static_cast<int>(contact.points[i].id);
        point.m_index1 = static_cast<int>(contact.feature);
        point.m_combinedFriction = friction;
        point.m_combinedRestitution = restitution;
        point.m_appliedImpulse = heritages[i].impulse;
        point.m_appliedImpulseLateral1 = heritages[i].lateral_1;
        point.m_appliedImpulseLateral2 = heritages[i].lateral_2;
        point.m_lateralFrictionDir1 = heritages[i].direction_1;
        point.m_lateralFrictionDir2 = heritages[i].direction_2;
        point.m_contactMotion1 = heritages[i].arrival;
        point.m_lifeTime = heritages[i].age;
    }
}

} // namespace pluvia
