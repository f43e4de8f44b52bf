#include "contact_memory.h"

#include "hull_pair.h"
#include "pluvia/src/world/bullet/ffi.rs.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>

namespace pluvia {

namespace {

// The smaller number first.
std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

std::uint32_t number(const btCollisionObject &body) {
    return body.isStaticOrKinematicObject() ? RecalledContacts::ANY_WALL
                                            : static_cast<std::uint32_t>(body.getUserIndex());
}

// Whether a point lies within a distance of one of the contact's.
bool near(const PairContact &contact, const btTransform &pose_a, const btVector3 &point,
          btScalar distance) {
    for (int i = 0; i < contact.count; ++i) {
        const double *x = contact.points[i].on_a;
        const btVector3 on_a(static_cast<btScalar>(x[0]), static_cast<btScalar>(x[1]),
                             static_cast<btScalar>(x[2]));
        if (pose_a(on_a).distance2(point) < distance * distance) {
            return true;
        }
    }
    return false;
}

} // namespace

btVector3 impulse_of(const btManifoldPoint &point) {
    return point.m_normalWorldOnB * point.m_appliedImpulse +
           point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
           point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2;
}

void remember(const Units &units, const btPersistentManifold &manifold,
              rust::Vec<ContactRead> &out) {
    const btCollisionObject &a = *manifold.getBody0();
    const btCollisionObject &b = *manifold.getBody1();
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
        const btManifoldPoint &point = manifold.getContactPoint(p);
        if (!(point.m_appliedImpulse > 0)) {
            continue;
        }
        const btVector3 on_a = a.getWorldTransform()(point.m_localPointA);
        const btVector3 on_b = b.getWorldTransform()(point.m_localPointB);
        ContactRead read{};
        read.a = number(a);
        read.b = number(b);
        read.point = units.metres((on_a + on_b) * btScalar(0.5));
        read.normal = array(point.m_normalWorldOnB);
        read.gap = units.metres((on_a - on_b).dot(point.m_normalWorldOnB));
        read.impulse = units.metres(impulse_of(point));
        out.push_back(read);
    }
}

void RecalledContacts::take(const Units &units, rust::Slice<const ContactRead> contacts) {
    for (const ContactRead &c : contacts) {
        const btScalar sign = c.a <= c.b ? 1 : -1;
        by_pair_[key(c.a, c.b)].push_back(
            {units.length(c.point), vector(c.normal) * sign, units.length(c.impulse) * sign});
    }
}

void RecalledContacts::give(const PairContact &contact, btScalar match,
                            btPersistentManifold &manifold) const {
    const btCollisionObject &a = *manifold.getBody0();
    const btCollisionObject &b = *manifold.getBody1();
    const auto found = by_pair_.find(key(number(a), number(b)));
    if (found == by_pair_.end()) {
        return;
    }
    const btScalar sign = number(a) <= number(b) ? 1 : -1;
    const btVector3 normal(static_cast<btScalar>(-contact.normal[0]),
                           static_cast<btScalar>(-contact.normal[1]),
                           static_cast<btScalar>(-contact.normal[2]));
    int given = 0;
    for (const Recalled &r : found->second) {
        // A grain in a corner leans on several walls.
        const bool same_side = (r.normal * sign).dot(normal) > btScalar(0.7);
        if (given == MANIFOLD_CACHE_SIZE || !same_side ||
            !near(contact, a.getWorldTransform(), r.point, match)) {
            continue;
        }
        btManifoldPoint point(a.getWorldTransform().invXform(r.point),
                              b.getWorldTransform().invXform(r.point), r.normal * sign, 0);
        const btVector3 impulse = r.impulse * sign;
        point.m_appliedImpulse = impulse.dot(point.m_normalWorldOnB);
        const btVector3 rest = impulse - point.m_normalWorldOnB * point.m_appliedImpulse;
        const btScalar size = rest.length();
        point.m_appliedImpulseLateral1 = size;
        point.m_lateralFrictionDir1 = size > 0 ? rest / size : btVector3(0, 0, 0);
        point.m_lateralFrictionDir2 = btVector3(0, 0, 0);
        point.m_index0 = -1; // no feature: taken over by distance
        manifold.setNumContacts(given + 1);
        manifold.getContactPoint(given) = point;
        ++given;
    }
}

} // namespace pluvia
