// The world with Pluvia's own step on Bullet's bodies and broadphase: renews boxes, finds and
// solves the contacts, moves the bodies.
#include "native_world.h"

#include "pluvia/src/world/bullet/ffi.rs.h"

#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace pluvia {

namespace {

// Bodies that a thread takes at once where little is done with each.
constexpr std::size_t BODIES_AT_ONCE = 128;

HullCollision hull_collision(const Units &units, const WorldDefinition &d,
                             const Materials &materials) {
    HullCollision collision(d.tolerances, units.scale(), d.portable);
    collision.materials = &materials;
    collision.settings.speculative_margin =
        std::min(d.contact_threshold, d.tolerances.contact_margin) * units.scale();
    collision.step = d.time_step;
    return collision;
}

} // namespace

NativeWorld::NativeWorld(const Units &units, const WorldDefinition &definition,
                         const Materials &materials)
    : EngineWorld(&dispatcher, &boxes, nullptr, &configuration), units_(units),
      slack_(units.length(definition.tolerances.box_slack)),
      damped_(definition.linear_damping > 0 || definition.angular_damping > 0),
      collision_(hull_collision(units, definition, materials)), workers_(definition.threads),
      search_(collision_, dispatcher, workers_),
      solver_(collision_.touching, units, definition, workers_) {}

void NativeWorld::add(btRigidBody &body, BodyKind kind) {
    EngineWorld::add(body, kind);
    collision_.bodies.expect(*body.getBroadphaseHandle());
    solver_.bodies_changed();
}

void NativeWorld::remove(btRigidBody &body) {
    if (solver_.has_parts(body.getUserIndex())) {
        throw std::runtime_error("others are parts of it, and leave first");
    }
    EngineWorld::remove(body);
    solver_.forget(body.getUserIndex());
    collision_.forget(body);
    if (followed_ == &body) {
        follow(nullptr);
    }
    drives_.erase(std::remove_if(drives_.begin(), drives_.end(),
                                 [&body](const Kinematic &next) { return next.body == &body; }),
                  drives_.end());
}

void NativeWorld::drive(btRigidBody &body, const btTransform &end) {
    drives_.push_back({&body, end});
}

void NativeWorld::join(btRigidBody &part, btRigidBody &whole) {
    const int number = whole.getUserIndex();
    if (&part == &whole || solver_.whole_of(number) != number ||
        solver_.has_parts(part.getUserIndex()) ||
        part.isStaticOrKinematicObject() != whole.isStaticOrKinematicObject()) {
        throw std::runtime_error(
            "a body without parts is a part of another that moves alike and is none");
    }
    solver_.join(part.getUserIndex(), number);
    // What the first search sees of it.
    part.setLinearVelocity(whole.getLinearVelocity());
    part.setAngularVelocity(whole.getAngularVelocity());
    // Pairs that end here take with them what they carry.
    collision_.forget(part);
    getPairCache()->setOverlapFilterCallback(&part_filter_);
    // Boxes that are added meet others at once.
    const btCollisionObjectArray &objects = getCollisionObjectArray();
    for (int i = 0; i < objects.size(); ++i) {
        if (objects[i] != &part && solver_.whole_of(objects[i]->getUserIndex()) == number) {
            getPairCache()->removeOverlappingPair(part.getBroadphaseHandle(),
                                                  objects[i]->getBroadphaseHandle(), &dispatcher);
        }
    }
}

bool NativeWorld::PartFilter::needBroadphaseCollision(btBroadphaseProxy *a,
                                                      btBroadphaseProxy *b) const {
    const bool groups = (a->m_collisionFilterGroup & b->m_collisionFilterMask) != 0 &&
                        (b->m_collisionFilterGroup & a->m_collisionFilterMask) != 0;
    const auto whole = [this](const btBroadphaseProxy &proxy) {
        return solver.whole_of(
            static_cast<const btCollisionObject *>(proxy.m_clientObject)->getUserIndex());
    };
    return groups && whole(*a) != whole(*b);
}

void NativeWorld::step(btScalar length) {
    const Stopwatch watch(phases_.integration);
    // A step that fails leaves none for the next.
    const std::vector<Kinematic> drives = std::exchange(drives_, {});
    if (followed_ == nullptr && !drives.empty()) {
        follow(drives.front().body);
    }
    solver_.sort_bodies(getCollisionObjectArray());
    begin_drives(drives, length);
    solver_.take_gains(static_cast<double>(getGravity().length()), static_cast<double>(length),
                       collision_.settings.speculative_margin, !collision_.recalled.empty(),
                       collision_.bodies.gains);
    damp(length);
    search();
    {
        const Stopwatch solving(phases_.solver, &phases_.integration);
        solver_.solve(static_cast<double>(length));
    }
    for (const Kinematic &moved : drives) {
        moved.body->setWorldTransform(moved.end);
    }
    // After those that are driven: their parts go with them.
    solver_.move_bodies(static_cast<double>(length));
    collision_.recalled.forget();
}

void NativeWorld::find_contacts() {
    const Stopwatch watch(phases_.integration);
    search();
}

void NativeWorld::search() {
    const Stopwatch watch(phases_.collision, &phases_.integration);
    // Bodies and pairs move in memory: should the search fail, nobody may look there.
    collision_.touching.clear();
    {
        const Stopwatch boxing(phases_.broadphase, &phases_.collision);
        renew_boxes();
        computeOverlappingPairs();
        boxes.m_deferedcollide = false; // boxes that are added meet others at once
    }
    search_.find(*getPairCache(), solver_.homes());
}

// Kinematic bodies without a pose for the end of the step stand still in it.
void NativeWorld::begin_drives(const std::vector<Kinematic> &drives, btScalar step) {
    for (btRigidBody *body : solver_.kinematic()) {
        body->setLinearVelocity(btVector3(0, 0, 0));
        body->setAngularVelocity(btVector3(0, 0, 0));
    }
    for (const Kinematic &moved : drives) {
        // As btRigidBody.cpp, saveKinematicState, 3.24.
        btVector3 velocity, spin;
        btTransformUtil::calculateVelocity(moved.body->getWorldTransform(), moved.end, step,
                                           velocity, spin);
        moved.body->setLinearVelocity(velocity);
        moved.body->setAngularVelocity(spin);
    }
    solver_.carry_parts();
}

void NativeWorld::damp(btScalar step) {
    if (!damped_) {
        return;
    }
    const auto count = static_cast<std::size_t>(m_nonStaticRigidBodies.size());
    workers_.each(count, BODIES_AT_ONCE, [&](std::size_t i) {
        btRigidBody &body = *m_nonStaticRigidBodies[static_cast<int>(i)];
        if (!body.isStaticOrKinematicObject()) {
            body.applyDamping(step);
        }
    });
}

btVector3 NativeWorld::place() const {
    return followed_ == nullptr ? start_ : start_ + followed_->getWorldTransform().getOrigin();
}

void NativeWorld::follow(const btRigidBody *body) {
    // The place does not jump: all boxes would have to be renewed.
    const btVector3 now = place();
    followed_ = body;
    start_ += now - place();
}

void NativeWorld::renew_boxes() {
    Frame frame;
    frame.origin = three(place());
    if (followed_ != nullptr) {
        frame.velocity = three(followed_->getLinearVelocity());
    }
    const btVector3 slack(slack_, slack_, slack_);
    const btCollisionObjectArray &objects = getCollisionObjectArray();
    collision_.bodies.begin(frame, objects, collision_.step,
                            collision_.settings.speculative_margin);
    // One after the other, each body would be paired with those that have not
    // got their new boxes yet, though all fall alike.
    boxes.m_deferedcollide = collision_.bodies.crowded();
    collision_.bodies.take(objects, *collision_.kernels, workers_, left_);
    // The tree of boxes is one thread's: where a box goes depends on those that went before.
    for (int i = 0; i < objects.size(); ++i) {
        if (left_[i] != 0) {
            btBroadphaseProxy *proxy = objects[i]->getBroadphaseHandle();
            const HullRange &range = collision_.bodies.range(HullBodies::index(*proxy));
            // Without a margin of the leaves, which Bullet has once for the whole process.
            boxes.setAabbForceUpdate(proxy, vector(three(range.low)) - slack,
                                     vector(three(range.high)) + slack, &dispatcher);
        }
    }
}

PhaseTimes NativeWorld::phases() const {
    PhaseTimes out = phases_;
    out.shared = workers_.shared().now;
    out.shared_on = workers_.shared().on;
    return out;
}

void NativeWorld::read_contacts(rust::Vec<ContactRead> &out) const {
    for (const Touching &pair : collision_.touching) {
        pluvia::read(units_, pair, out);
    }
}

void NativeWorld::remember_contacts(rust::Vec<ContactRead> &out) const {
    for (const Touching &pair : collision_.touching) {
        remember(units_, pair, out);
    }
}

void NativeWorld::recall_contacts(rust::Slice<const ContactRead> contacts) {
    collision_.recalled.take(units_, contacts);
}

// As pairs get theirs.
PairValue NativeWorld::pair_value(const btRigidBody &a, const btRigidBody &b) const {
    return collision_.materials->of(a.getUserIndex(), b.getUserIndex());
}

void NativeWorld::read_settings(ReadBack &out) const {
    out.put("native_speculative_margin_m", units_.metres(collision_.settings.speculative_margin));
    out.put("native_hysteresis_m", units_.metres(collision_.settings.hysteresis));
    out.put("native_face_preference_m", units_.metres(collision_.settings.face_preference));
    out.put("native_hold_m", units_.metres(collision_.settings.hold));
    out.put("native_match_m", units_.metres(collision_.match));
    out.put("box_slack_m", units_.metres(slack_));
    out.put("threads", workers_.count());
    const ContactLaw &law = solver_.law();
    out.put("portable_instructions", collision_.kernels == &axis_kernels(true));
    out.put("gyroscopic", solver_.gyroscopic());
    out.put("substeps", law.substeps);
    out.put("iterations_in_a_substep", law.iterations);
    out.put("solver_tolerance", law.unsolved_share);
    out.put("contact_stiffness_n_per_m", law.stiffness);
    out.put("contact_damping_ratio", law.damping_ratio);
    out.put("max_depenetration_velocity_m_per_s", units_.metres(law.max_depenetration_velocity));
    out.put("restitution_speed_m_per_s", units_.metres(law.restitution_speed));
    out.put("closed_gap_m", units_.metres(law.closed_gap));
    out.put("unsolved_gap_m", units_.metres(law.unsolved_gap));
    out.put("contacts_at_once", solver_.one_by_one() ? 1 : 8);
}

} // namespace pluvia
