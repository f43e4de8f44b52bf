#include "contact_memory.h"

#include "hull_algorithm.h"
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

namespace {

template <class N> btVector3 vector(const N x[3]) {
    return btVector3(static_cast<btScalar>(x[0]), static_cast<btScalar>(x[1]),
                     static_cast<btScalar>(x[2]));
}

// What does not depend on where the bodies are.
ContactRead described(const Units &units, const Touching &pair, int point) {
    const KeptContact &contact = pair.state->memory.last;
    ContactRead read{};
    read.a = number(*pair.a->object);
    read.b = number(*pair.b->object);
    read.normal = array(-vector(contact.normal));
    read.gap = static_cast<double>(contact.points[point].gap) / units.scale();
    read.impulse = units.metres(vector(pair.state->loads[point].impulse));
    read.warm_start = static_cast<double>(pair.state->loads[point].warm_start);
    read.feature = contact.feature;
    read.id = contact.points[point].id;
    return read;
}

// Where a point of a body is now that was where it is in the body's frame when the step began;
// `out` is the normal out of the body, in the world. What the ball of a rounded polyhedron adds to
// its core, or a sphere to its centre, stays where it is.
btVector3 now(const HullBody &body, const float on[3], const btVector3 &out) {
    const btTransform &pose = body.object->getWorldTransform();
    const bool rounded = body.hull->is_rounded();
    if (!rounded && !body.hull->is_sphere()) {
        return pose(vector(on));
    }
    double arm[3];
    body.pose.turn(on, arm);
    if (!rounded) {
        return pose.getOrigin() + vector(arm);
    }
    const btVector3 ball = out * static_cast<btScalar>(body.hull->rounding);
    const btVector3 core = vector(arm) - ball;
    const double world[3] = {static_cast<double>(core.x()), static_cast<double>(core.y()),
                             static_cast<double>(core.z())};
    double local[3];
    body.pose.inverse().turn(world, local);
    return pose(vector(local)) + ball;
}

} // namespace

void read(const Units &units, const Touching &pair, rust::Vec<ContactRead> &out) {
    const KeptContact &contact = pair.state->memory.last;
    for (int p = 0; p < contact.count; ++p) {
        double on_a[3], on_b[3];
        pair.a->pose.apply(contact.points[p].on_a, on_a);
        pair.b->pose.apply(contact.points[p].on_b, on_b);
        ContactRead read = described(units, pair, p);
        read.point = units.metres((vector(on_a) + vector(on_b)) * btScalar(0.5));
        out.push_back(read);
    }
}

void remember(const Units &units, const Touching &pair, rust::Vec<ContactRead> &out) {
    const KeptContact &contact = pair.state->memory.last;
    const btVector3 normal = -vector(contact.normal);
    for (int p = 0; p < contact.count; ++p) {
        if (!(vector(pair.state->loads[p].impulse).dot(normal) > 0)) {
            continue;
        }
        const btVector3 on_a = now(*pair.a, contact.points[p].on_a, -normal);
        const btVector3 on_b = now(*pair.b, contact.points[p].on_b, normal);
        ContactRead read = described(units, pair, p);
        read.point = units.metres((on_a + on_b) * btScalar(0.5));
        read.gap = units.metres((on_a - on_b).dot(normal));
        out.push_back(read);
    }
}

void RecalledContacts::take(const Units &units, rust::Slice<const ContactRead> contacts) {
    for (const ContactRead &c : contacts) {
        Recalled recalled{units.length(c.point),
                          vector(c.normal),
                          units.length(c.impulse),
                          static_cast<float>(c.warm_start),
                          c.feature,
                          c.id};
        if (c.a > c.b) { // added in another order to the world that remembered it
            recalled.normal = -recalled.normal;
            recalled.impulse = -recalled.impulse;
            recalled.feature = swapped_feature(c.feature);
            recalled.id = swapped_id(c.id);
        }
        by_pair_[key(std::min(c.a, c.b), std::max(c.a, c.b))].push_back(recalled);
    }
}

const std::vector<RecalledContacts::Recalled> *
RecalledContacts::of(const btCollisionObject &a, const btCollisionObject &b) const {
    const auto found = by_pair_.find(key(number(a), number(b)));
    return found == by_pair_.end() ? nullptr : &found->second;
}

void RecalledContacts::give(const btCollisionObject &a, const btCollisionObject &b,
                            const HullData &hull_a, const HullData &hull_b,
                            PairState &state) const {
    const std::vector<Recalled> *points = of(a, b);
    if (points == nullptr) {
        return;
    }
    recall(hull_a, hull_b, points->front().feature, state.memory);
    KeptContact &contact = state.memory.last;
    contact.count = static_cast<int>(std::min<std::size_t>(points->size(), MOST_POINTS));
    for (int i = 0; i < contact.count; ++i) {
        const Recalled &r = (*points)[static_cast<std::size_t>(i)];
        const btVector3 on_a = a.getWorldTransform().invXform(r.point);
        const btVector3 on_b = b.getWorldTransform().invXform(r.point);
        KeptPoint &point = contact.points[i];
        point.id = r.id;
        state.loads[i].warm_start = r.warm_start;
        for (int k = 0; k < 3; ++k) {
            contact.normal[k] = static_cast<float>(-r.normal[k]);
            point.on_a[k] = static_cast<float>(on_a[k]);
            point.on_b[k] = static_cast<float>(on_b[k]);
            state.loads[i].impulse[k] = static_cast<float>(r.impulse[k]);
        }
    }
}

} // namespace pluvia
