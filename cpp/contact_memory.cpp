#include "contact_memory.h"

#include "pluvia/src/world/bullet/ffi.rs.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>

namespace pluvia {

namespace {

std::uint32_t number(const btCollisionObject &body) {
    return static_cast<std::uint32_t>(body.getUserIndex());
}

// Bullet has the bodies of a pair in the order in which they were added.
std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t(a) << 32 | b; }

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
        read.feature = static_cast<std::uint32_t>(point.m_index1);
        read.id = static_cast<std::uint32_t>(point.m_index0);
        out.push_back(read);
    }
}

void RecalledContacts::take(const Units &units, rust::Slice<const ContactRead> contacts) {
    for (const ContactRead &c : contacts) {
        by_pair_[key(c.a, c.b)].push_back(
            {units.length(c.point), vector(c.normal), units.length(c.impulse), c.feature, c.id});
    }
}

const std::vector<RecalledContacts::Recalled> *
RecalledContacts::of(const btCollisionObject &a, const btCollisionObject &b) const {
    const auto found = by_pair_.find(key(number(a), number(b)));
    return found == by_pair_.end() ? nullptr : &found->second;
}

void RecalledContacts::give(const btCollisionObject &a, const btCollisionObject &b,
                            const HullData &hull_a, const HullData &hull_b,
                            PairMemory &memory) const {
    const std::vector<Recalled> *points = of(a, b);
    if (points == nullptr) {
        return;
    }
    std::uint32_t ids[4];
    const int count = static_cast<int>(std::min<std::size_t>(points->size(), 4));
    for (int i = 0; i < count; ++i) {
        ids[i] = (*points)[static_cast<std::size_t>(i)].id;
    }
    recall(hull_a, hull_b, points->front().feature, ids, count, memory);
}

void RecalledContacts::give(btPersistentManifold &manifold) const {
    const btCollisionObject &a = *manifold.getBody0();
    const btCollisionObject &b = *manifold.getBody1();
    const std::vector<Recalled> *points = of(a, b);
    if (points == nullptr) {
        return;
    }
    const int count = static_cast<int>(std::min<std::size_t>(points->size(), MANIFOLD_CACHE_SIZE));
    manifold.setNumContacts(count);
    for (int i = 0; i < count; ++i) {
        const Recalled &r = (*points)[static_cast<std::size_t>(i)];
        btManifoldPoint &point = manifold.getContactPoint(i);
        point = btManifoldPoint(a.getWorldTransform().invXform(r.point),
                                b.getWorldTransform().invXform(r.point), r.normal, 0);
        point.m_appliedImpulse = r.impulse.dot(r.normal);
        const btVector3 rest = r.impulse - r.normal * point.m_appliedImpulse;
        const btScalar size = rest.length();
        point.m_appliedImpulseLateral1 = size;
        point.m_lateralFrictionDir1 = size > 0 ? rest / size : btVector3(0, 0, 0);
        point.m_lateralFrictionDir2 = btVector3(0, 0, 0);
        point.m_index0 = static_cast<int>(r.id);
    }
}

} // namespace pluvia
