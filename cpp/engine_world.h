// What both kinds of world are to the bridge: Bullet's world, which has the bodies,
// their shapes, boxes and pairs of boxes, and a clock.
#pragma once

#include "bodies.h"
#include "shapes.h"
#include "workers.h"

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <chrono>

namespace pluvia {

struct ContactRead;

// Sizes of Bullet's pools for what pairs carry.
inline btDefaultCollisionConstructionInfo pool_sizes(int pairs) {
    btDefaultCollisionConstructionInfo info;
    info.m_defaultMaxPersistentManifoldPoolSize = pairs;
    info.m_defaultMaxCollisionAlgorithmPoolSize = pairs;
    return info;
}

// Adds the time from its making to its end to a sum, and takes it from another, if any.
class Stopwatch {
  public:
    explicit Stopwatch(double &sum, double *of = nullptr) : sum_(sum), of_(of) {}
    ~Stopwatch() {
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
        sum_ += spent.count();
        if (of_ != nullptr) {
            *of_ -= spent.count();
        }
    }
    Stopwatch(const Stopwatch &) = delete;
    Stopwatch &operator=(const Stopwatch &) = delete;

  private:
    double &sum_;
    double *of_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Settings as read back, one name and one number each.
struct ReadBack {
    rust::Vec<EngineSetting> settings;

    void put(const char *name, double value) { settings.push_back({rust::String(name), value}); }
};

// Either `StockWorld`, Bullet as it comes, or `NativeWorld`, whose steps are
// Pluvia's own. What only native worlds can do is declared there.
class EngineWorld : public btDiscreteDynamicsWorld {
  public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

    // The definition with the mass and the moments of inertia that a body gets.
    virtual BodyDefinition applied(const BodyDefinition &definition, const btCollisionShape &) {
        return definition;
    }
    // Largest ratio of the moments of inertia given to a free body to the exact
    // ones of the mass that it was given.
    virtual double largest_inertia_ratio() const { return 1; }

    virtual void add(btRigidBody &body, BodyKind kind) {
        const bool free = kind == BodyKind::Free;
        addRigidBody(&body, free ? Group::FREE : Group::WALL,
                     free ? Group::FREE | Group::WALL : Group::FREE);
    }
    virtual void remove(btRigidBody &body) { removeRigidBody(&body); }
    // Where a kinematic body is at the end of the next step.
    virtual void drive(btRigidBody &body, const btTransform &end) = 0;
    virtual void step(btScalar length) = 0;
    // As they were when the last step began, or at the last search.
    virtual void read_contacts(rust::Vec<ContactRead> &out) const = 0;
    // Of a pair that touches.
    virtual PairValue pair_value(const btRigidBody &a, const btRigidBody &b) const = 0;
    // Settings as they act on the world, beside those of both kinds.
    virtual void read_settings(ReadBack &out) const = 0;
    // Likewise those that all free bodies have alike, read from one of them.
    virtual void read_body(const btRigidBody &, ReadBack &) const {}
    virtual PhaseTimes phases() const { return phases_; }

  protected:
    // `broadphase`: boxes and candidate pairs; `collision`: contacts of the candidate pairs;
    // `integration`: everything else.
    PhaseTimes phases_{0, 0, 0, 0, 0, SharedTime::THREADS, {}};
};

} // namespace pluvia
