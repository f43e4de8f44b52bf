// Reads pose, motion and axis-aligned box of every body once a step, for the search for contacts.
#include "hull_bodies.h"

#include "convert.h"
#include "pool.h"
#include "shapes.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

// How many bodies ahead the memory is asked for the object, for its proxy and
// shape, for the shape's hull and for the hull's vertices: each leads to the
// next, and must have come before it can be followed.
constexpr int OBJECT_AHEAD = 12;
constexpr int SHAPE_AHEAD = 8;
constexpr int HULL_AHEAD = 5;
constexpr int VERTICES_AHEAD = 2;

// Bodies that a thread takes at once.
constexpr std::size_t BODIES_AT_ONCE = 64;

// Speeds against the bodies around are looked for where a body went this number of
// speculative margins in the last step: else there is little to be had.
constexpr double CROWD_MARGINS = 2;

bool holds(const btBroadphaseProxy &proxy, const HullRange &range) {
    for (int i = 0; i < 3; ++i) {
        if (static_cast<btScalar>(range.low[i]) < proxy.m_aabbMin[i] ||
            static_cast<btScalar>(range.high[i]) > proxy.m_aabbMax[i]) {
            return false;
        }
    }
    return true;
}

// A rigid body whose shape is a TightHull.
HullBody hull_body(const btCollisionObject &object, const Gains &gains) {
    const btRigidBody &body = *btRigidBody::upcast(&object);
    const auto &shape = static_cast<const TightHull &>(*object.getCollisionShape());
    HullBody out;
    out.object = &object;
    out.hull = &shape.data();
    out.number = object.getUserIndex();
    out.pose = rigid(object.getWorldTransform());
    out.motion = {three(body.getLinearVelocity()), three(body.getAngularVelocity())};
    // The surface of a sphere stays where it is while the sphere turns.
    const btScalar turns = out.hull->is_sphere()    ? 0
                           : out.hull->is_rounded() ? btScalar(out.hull->core_radius())
                                                    : shape.radius();
    out.besides = static_cast<double>(body.getAngularVelocity().length() * turns);
    if (!object.isStaticOrKinematicObject()) {
        out.besides += gains.free;
        return out;
    }
    for (const Gains::Of &other : gains.others) {
        out.besides += other.number == out.number ? other.speed : 0;
    }
    return out;
}

} // namespace

Rigid rigid(const btTransform &pose) {
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] = static_cast<double>(pose.getBasis()[i][j]);
        }
    }
    out.t = three(pose.getOrigin());
    return out;
}

double approach_in_step(const HullBody &a, const HullBody &b, double step) {
    return step * (length(a.motion.velocity - b.motion.velocity) + a.besides + b.besides);
}

void HullBodies::begin(const Frame &frame, const btCollisionObjectArray &objects, double step,
                       double margin) {
    moved_ = frame.origin - frame_.origin;
    bodies_.resize(std::max(most_, bodies_.size()));
    ranges_.resize(bodies_.size());
    frame_ = frame;
    step_ = step;
    margin_ = margin;
    const bool fast = fastest_ * step > CROWD_MARGINS * margin;
    fastest_ = 0;
    crowded_ = fast && gather(objects);
}

bool HullBodies::gather(const btCollisionObjectArray &objects) {
    members_.clear();
    for (int i = 0; i < objects.size(); ++i) {
        ask_ahead(objects, i);
        const HullBody &body = read(*objects[i]);
        const Vec &t = body.pose.t;
        members_.push_back({{t.x, t.y, t.z},
                            body.motion.velocity,
                            static_cast<double>(body.hull->radius),
                            body.besides,
                            !objects[i]->isStaticOrKinematicObject()});
    }
    return crowd_.gather(members_, frame_.velocity, step_, margin_);
}

void HullBodies::ask_ahead(const btCollisionObjectArray &objects, int i) {
    const auto at = [&](int ahead) -> const btRigidBody * {
        return i + ahead < objects.size() ? btRigidBody::upcast(objects[i + ahead]) : nullptr;
    };
    const auto shape_of = [](const btRigidBody &body) -> const TightHull & {
        return static_cast<const TightHull &>(*body.getCollisionShape());
    };
    if (i + OBJECT_AHEAD < objects.size()) {
        prefetch(static_cast<const btRigidBody &>(*objects[i + OBJECT_AHEAD]));
    }
    if (const btRigidBody *body = at(SHAPE_AHEAD)) {
        prefetch(*body->getBroadphaseHandle());
        prefetch(shape_of(*body));
    }
    if (const btRigidBody *body = at(HULL_AHEAD)) {
        prefetch(shape_of(*body).data());
    }
    if (const btRigidBody *body = at(VERTICES_AHEAD)) {
        const HullData &hull = shape_of(*body).data();
        prefetch(hull.vx, hull.vz + hull.vertices);
    }
}

HullBody &HullBodies::read(const btCollisionObject &object) {
    const std::size_t at = index(*object.getBroadphaseHandle());
    HullBody &body = bodies_[at];
    const HullBody before = body;
    body = hull_body(object, gains);
    if (before.object == body.object) {
        ranges_[at].travelled += displacement(body, before.pose, moved_);
    }
    return body;
}

void HullBodies::take(const btCollisionObjectArray &objects, const AxisKernels &kernels,
                      Workers &workers, std::vector<std::uint8_t> &left) {
    const auto count = static_cast<std::size_t>(objects.size());
    left.resize(count);
    fastest_of_.assign(static_cast<std::size_t>(workers.count()), 0);
    const Share all{count, BODIES_AT_ONCE, BODIES_AT_ONCE};
    workers.share(&all, 1, [&](std::size_t, int worker, std::size_t begin, std::size_t end) {
        double own = 0;
        for (std::size_t n = begin; n < end; ++n) {
            const int i = static_cast<int>(n);
            const HullRange &range = take(objects, i, kernels, own);
            left[n] = !holds(*objects[i]->getBroadphaseHandle(), range);
        }
        double &most = fastest_of_[static_cast<std::size_t>(worker)];
        most = std::max(most, own);
    });
    fastest_ = *std::max_element(fastest_of_.begin(), fastest_of_.end());
}

const HullRange &HullBodies::take(const btCollisionObjectArray &objects, int i,
                                  const AxisKernels &kernels, double &fastest) {
    const btCollisionObject &object = *objects[i];
    ask_ahead(objects, i);
    const std::size_t at = index(*object.getBroadphaseHandle());
    const HullBody &body = crowded_ ? bodies_[at] : read(object);
    HullRange &range = ranges_[at];
    if (body.hull->is_sphere()) {
        std::fill(range.low, range.low + 3, -body.hull->radius);
        std::fill(range.high, range.high + 3, body.hull->radius);
    } else {
        float turned[9];
        std::copy(body.pose.r, body.pose.r + 9, turned);
        kernels.box(*body.hull, turned, range.low, range.high);
        const auto ball = static_cast<float>(body.hull->rounding);
        for (int k = 0; k < 3; ++k) {
            range.low[k] -= ball;
            range.high[k] += ball;
        }
    }
    const double speed = length(body.motion.velocity - frame_.velocity);
    fastest = std::max(fastest, speed);
    const double against = crowded_ ? crowd_.speed(static_cast<std::size_t>(i)) : speed;
    range.around = static_cast<float>(margin_ / 2 + step_ * (against + body.besides));
    store(body.pose.t - frame_.origin, range.centre);
    for (int k = 0; k < 3; ++k) {
        range.low[k] += range.centre[k] - range.around;
        range.high[k] += range.centre[k] + range.around;
    }
    range.radius = body.hull->radius + range.around;
    return range;
}

// As `farthest_displacement` of a pair: that of the centre, and the turning times the radius.
double HullBodies::displacement(const HullBody &body, const Rigid &before, const Vec &moved) {
    double turn = 0;
    for (int i = 0; i < 9; ++i) {
        turn += (body.pose.r[i] - before.r[i]) * (body.pose.r[i] - before.r[i]);
    }
    const auto radius = static_cast<double>(body.hull->core_radius());
    return length(body.pose.t - (before.t + moved)) + std::sqrt(turn / 2) * radius;
}

} // namespace pluvia
