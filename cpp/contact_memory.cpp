// Carries impulses from a pair's old contact points to its new ones, and saves and restores
// contacts for another world.
#include "contact_memory.h"

#include "hull_algorithm.h"
#include "pluvia/src/world/bullet/ffi.rs.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>
#include <numeric>

namespace pluvia {

namespace {

// Cosine of the angle between old and new normal from which impulses go on as they are.
constexpr double SAME_NORMAL = 0.99;

double square(const float a[3], const float b[3]) {
    const float d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return three(d).dot(three(d));
}

// For each new point the old one that it continues, or -1.
void match_points(const KeptContact &contact, const KeptContact &before, double match,
                  int from[MOST_POINTS]) {
    bool taken[MOST_POINTS] = {};
    int left = 0;
    for (int i = 0; i < contact.count; ++i) {
        from[i] = -1;
        for (int k = 0; k < before.count && from[i] < 0; ++k) {
            if (!taken[k] && before.points[k].id == contact.points[i].id) {
                from[i] = k;
                taken[k] = true;
            }
        }
        left += from[i] < 0;
    }
    // What is left: nearest first, so that the result does not depend on the order.
    while (left > 0) {
        double nearest = match * match;
        int new_point = -1;
        int old_point = -1;
        for (int i = 0; i < contact.count; ++i) {
            for (int k = 0; k < before.count; ++k) {
                if (from[i] >= 0 || taken[k]) {
                    continue;
                }
                const KeptPoint &point = contact.points[i];
                const KeptPoint &old = before.points[k];
                const double distance =
                    std::min(square(old.on_a, point.on_a), square(old.on_b, point.on_b));
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

// A load on a contact whose normal has turned; normals lead out of A, so that
// what presses on A points against them.
Load turned(const Load &load, const Vec &before, const Vec &now) {
    Load out = load;
    const Vec impulse = three(load.impulse);
    const Vec &normal = before.dot(now) >= SAME_NORMAL ? before : now;
    const double pressed = std::max(0.0, -impulse.dot(normal));
    const Vec rest = impulse + normal * pressed;
    // What would pull holds by no friction.
    store(pressed > 0 ? rest - now * (rest.dot(now) + pressed) : Vec{0, 0, 0}, out.impulse);
    return out;
}

std::uint32_t number(const btCollisionObject &body) {
    return static_cast<std::uint32_t>(body.getUserIndex());
}

// Bullet has the bodies of a pair in the order in which they were added.
std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t(a) << 32 | b; }

// What does not depend on where the bodies are.
ContactRead described(const Units &units, const Touching &pair, int point) {
    const KeptContact &contact = pair.state->memory.last;
    ContactRead read{};
    read.a = number(*pair.a->object);
    read.b = number(*pair.b->object);
    read.normal = array(-three(contact.normal));
    read.gap = units.metres(static_cast<double>(contact.points[point].gap));
    read.impulse = units.metres(three(pair.state->loads[point].impulse));
    read.warm_start = static_cast<double>(pair.state->loads[point].warm_start);
    read.feature = contact.feature;
    read.id = contact.points[point].id;
    return read;
}

// Where a point of a body is now that was where it is in the body's frame when the step began;
// `out` is the normal out of the body, in the world. What the ball of a rounded polyhedron adds to
// its core, or a sphere to its centre, stays where it is.
btVector3 now(const HullBody &body, const Vec &on, const btVector3 &out) {
    const btTransform &pose = body.object->getWorldTransform();
    const bool rounded = body.hull->is_rounded();
    if (!rounded && !body.hull->is_sphere()) {
        return pose(vector(on));
    }
    const btVector3 arm = vector(body.pose.turn(on));
    if (!rounded) {
        return pose.getOrigin() + arm;
    }
    const btVector3 ball = out * static_cast<btScalar>(body.hull->rounding);
    return pose(vector(body.pose.turn_back(three(arm - ball)))) + ball;
}

} // namespace

void take_contact(const PairContact &contact, double match, PairState &state) {
    const KeptContact before = state.memory.last;
    KeptContact &now = state.memory.last;
    now.keep(contact);
    const Vec old_normal = three(before.normal), new_normal = three(now.normal);
    int from[MOST_POINTS];
    std::iota(from, from + MOST_POINTS, 0);
    if (!contact.held) {
        match_points(now, before, match, from);
    }
    Load loads[MOST_POINTS];
    for (int i = 0; i < now.count; ++i) {
        if (from[i] >= 0) {
            loads[i] = turned(state.loads[from[i]], old_normal, new_normal);
        }
    }
    std::copy(loads, loads + now.count, state.loads);
}

void read(const Units &units, const Touching &pair, rust::Vec<ContactRead> &out) {
    const KeptContact &contact = pair.state->memory.last;
    for (int p = 0; p < contact.count; ++p) {
        const Vec on_a = pair.a->pose.apply(three(contact.points[p].on_a));
        const Vec on_b = pair.b->pose.apply(three(contact.points[p].on_b));
        ContactRead read = described(units, pair, p);
        read.point = units.metres((vector(on_a) + vector(on_b)) * btScalar(0.5));
        out.push_back(read);
    }
}

void remember(const Units &units, const Touching &pair, rust::Vec<ContactRead> &out) {
    const KeptContact &contact = pair.state->memory.last;
    const btVector3 normal = -vector(three(contact.normal));
    for (int p = 0; p < contact.count; ++p) {
        if (!(vector(three(pair.state->loads[p].impulse)).dot(normal) > 0)) {
            continue;
        }
        const btVector3 on_a = now(*pair.a, three(contact.points[p].on_a), -normal);
        const btVector3 on_b = now(*pair.b, three(contact.points[p].on_b), normal);
        ContactRead read = described(units, pair, p);
        read.point = units.metres((on_a + on_b) * btScalar(0.5));
        read.gap = units.metres((on_a - on_b).dot(normal));
        out.push_back(read);
    }
}

void RecalledContacts::take(const Units &units, rust::Slice<const ContactRead> contacts) {
    for (const ContactRead &c : contacts) {
        Recalled recalled{units.length(c.point),
                          vector(three(c.normal.data())),
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

void RecalledContacts::give(const HullBody &a, const HullBody &b, PairState &state) const {
    const auto found = by_pair_.find(key(number(*a.object), number(*b.object)));
    if (found == by_pair_.end()) {
        return;
    }
    const std::vector<Recalled> &points = found->second;
    recall(*a.hull, *b.hull, points.front().feature, state.memory);
    KeptContact &contact = state.memory.last;
    contact.count = static_cast<int>(std::min<std::size_t>(points.size(), MOST_POINTS));
    for (int i = 0; i < contact.count; ++i) {
        const Recalled &r = points[i];
        KeptPoint &point = contact.points[i];
        point.id = r.id;
        store(three(a.object->getWorldTransform().invXform(r.point)), point.on_a);
        store(three(b.object->getWorldTransform().invXform(r.point)), point.on_b);
        store(three(-r.normal), contact.normal);
        store(three(r.impulse), state.loads[i].impulse);
        state.loads[i].warm_start = r.warm_start;
    }
}

} // namespace pluvia
