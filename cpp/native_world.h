// The world whose contacts Pluvia finds and solves.
#pragma once

#include "contact_solver.h"
#include "engine_world.h"
#include "hull_search.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace pluvia {

// What the world is made of; it must be there before it, and after.
struct NativeParts {
    btDefaultCollisionConfiguration configuration{pool_sizes(1)}; // Bullet's contacts are not kept
    HullDispatcher dispatcher{&configuration};
    btDbvtBroadphase boxes;
};

// Bullet has the bodies, their shapes and the tree of their boxes, which finds the
// pairs that may touch. The step is Pluvia's own, and takes nothing of Bullet's but
// how a body is damped and moved: Bullet's contacts have no memory of what touched,
// its solver sees one point at a time, and its step goes over all bodies nine times.
//
// Bodies come and go by `add` and `remove` alone.
//
// The boxes are larger than the bodies, so that a body takes a new one only when
// it has left the old, and they are counted from a place that moves along with
// the apparatus, so that shaking alone lets none leave. Contacts are found where
// bodies are at the beginning of the step, kinematic ones as all others.
class NativeWorld final : private NativeParts, public EngineWorld {
  public:
    // `materials` must outlive the world.
    NativeWorld(const Units &units, const WorldDefinition &definition, const Materials &materials);

    // Bullet's own align by 16 bytes, whatever the members need.
    static void *operator new(std::size_t size) {
        return ::operator new(size, std::align_val_t(alignof(NativeWorld)));
    }
    static void operator delete(void *world) {
        ::operator delete(world, std::align_val_t(alignof(NativeWorld)));
    }

    void add(btRigidBody &body, BodyKind kind) override;
    void remove(btRigidBody &body) override;
    void drive(btRigidBody &body, const btTransform &end) override;
    void step(btScalar length) override;
    void read_contacts(rust::Vec<ContactRead> &out) const override;
    PairValue pair_value(const btRigidBody &a, const btRigidBody &b) const override;
    void read_settings(ReadBack &out) const override;
    PhaseTimes phases() const override;

    // Makes a body without parts a further part of another, which has the same pose and is none.
    void join(btRigidBody &part, btRigidBody &whole);
    void remember_contacts(rust::Vec<ContactRead> &out) const;
    void recall_contacts(rust::Slice<const ContactRead> contacts);
    // Without a step.
    void find_contacts();
    ContactSolver &solver() { return solver_; }
    // Whether one thread does the steps from now on.
    void leave_alone(bool on) { workers_.leave_alone(on); }

  private:
    // Bullet's rule, and parts of one body never meet.
    struct PartFilter final : btOverlapFilterCallback {
        explicit PartFilter(const ContactSolver &of) : solver(of) {}
        bool needBroadphaseCollision(btBroadphaseProxy *a, btBroadphaseProxy *b) const override;

        const ContactSolver &solver;
    };

    struct Kinematic {
        btRigidBody *body;
        btTransform end; // of the step
    };

    Units units_;
    btScalar slack_; // by which boxes are larger
    bool damped_;
    HullCollision collision_;
    Workers workers_;
    HullSearch search_;
    ContactSolver solver_;
    PartFilter part_filter_{solver_};
    std::vector<Kinematic> drives_;  // those that the next step moves
    std::vector<std::uint8_t> left_; // by object: whether it has left its box
    const btRigidBody *followed_ = nullptr;
    btVector3 start_{0, 0, 0}; // where the place would be had the body not moved from the origin

    btVector3 place() const;
    // The body that boxes move along with from now on; null for none.
    void follow(const btRigidBody *body);
    void search();
    void renew_boxes();
    void begin_drives(const std::vector<Kinematic> &drives, btScalar step);
    void damp(btScalar step);
};

} // namespace pluvia
