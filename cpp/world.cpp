#include "world.h"

#include "bodies.h"
#include "contact_memory.h"
#include "contact_setup.h"
#include "convert.h"
#include "drives.h"
#include "globals.h"
#include "hull_world.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "settings.h"
#include "shapes.h"
#include "stock.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace pluvia {

namespace {

btDefaultCollisionConstructionInfo pool_sizes(bool own_collision) {
    // Bullet falls back to the heap when a pool is full, which is slow. A
    // dense specimen of 1456 grains holds about 20 000 pairs. Pluvia's own
    // contacts have a pool of their own.
    const int pairs = own_collision ? 1 : 32768;
    btDefaultCollisionConstructionInfo info;
    info.m_defaultMaxPersistentManifoldPoolSize = pairs;
    info.m_defaultMaxCollisionAlgorithmPoolSize = pairs;
    return info;
}

} // namespace

// Members are destroyed from the last to the first: the world before what it
// uses, bodies and shapes after the world that pointed to them.
class BulletWorld::Impl {
  public:
    Impl(const WorldDefinition &definition, rust::Slice<const PairValue> pairs)
        : units(definition.length_scale), time_step(static_cast<btScalar>(definition.time_step)),
          body_settings{static_cast<btScalar>(definition.linear_damping),
                        static_cast<btScalar>(definition.angular_damping), definition.gyroscopic},
          margin(definition.collision_margin),
          box_slack(units.length(definition.tolerances.box_slack)),
          stock(units, definition), materials{definition.materials, {pairs.begin(), pairs.end()}},
          globals(global_settings(units, definition)),
          hull_collision(definition.own_collision ? make_hull_collision(units, definition)
                                                  : nullptr),
          configuration(pool_sizes(definition.own_collision)),
          dispatcher(&configuration, hull_collision.get(), definition.threads),
          contact_solver(
              definition.own_collision
                  ? make_contact_solver(units, definition, *hull_collision, dispatcher.workers())
                  : nullptr),
          hull_world(make_hull_world()), bullet_world(make_bullet_world()),
          world(hull_world ? *hull_world : *bullet_world) {
        set_world(world, units, definition);
        // A relative threshold destroys manifolds: used only where it is asked for.
        const int relative = btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD;
        const int flags = dispatcher.getDispatcherFlags() & ~relative;
        if (definition.relative_contact_threshold > 0) {
            dispatcher.setDispatcherFlags(flags | relative);
            // Ours leaves out what is further apart than the absolute one.
            dispatcher.setNearCallback(&btCollisionDispatcher::defaultNearCallback);
        } else {
            dispatcher.setDispatcherFlags(flags);
        }
    }

    ~Impl() {
        // Pair by pair: a body that leaves looks through all pairs for its own.
        auto &pairs = *broadphase.getOverlappingPairCache();
        while (pairs.getNumOverlappingPairs() > 0) {
            const btBroadphasePair last =
                pairs.getOverlappingPairArray()[pairs.getNumOverlappingPairs() - 1];
            pairs.removeOverlappingPair(last.m_pProxy0, last.m_pProxy1, &dispatcher);
        }
        for (auto &body : bodies) {
            if (body) {
                world.removeRigidBody(body.get());
            }
        }
    }

    btRigidBody &body(std::uint32_t id) const {
        if (id >= bodies.size() || !bodies[id]) {
            throw std::runtime_error("no body " + std::to_string(id) + " in this world");
        }
        return *bodies[id];
    }

    Units units;
    btScalar time_step;
    Drives drives;
    DampingAndSpin body_settings;
    double margin; // m
    btScalar box_slack;
    StockRules stock;
    Materials materials;
    GlobalsHold globals;
    std::vector<std::unique_ptr<TightHull>> shapes;
    Pool body_pool{sizeof(btRigidBody)};
    std::vector<BodyPtr> bodies;
    // Of Pluvia's own hull–hull test; null where Bullet finds the contacts.
    std::unique_ptr<HullCollision> hull_collision;
    btDefaultCollisionConfiguration configuration;
    HullDispatcher dispatcher;
    btDbvtBroadphase broadphase;
    // Ours where the contacts are ours; null where they are Bullet's.
    std::unique_ptr<ContactSolver> contact_solver;
    btSequentialImpulseConstraintSolver bullet_solver;
    // One of them is null.
    std::unique_ptr<HullWorld> hull_world;
    std::unique_ptr<PhasedWorld> bullet_world;
    PhasedWorld &world;

    std::unique_ptr<HullWorld> make_hull_world() {
        if (!hull_collision) {
            return nullptr;
        }
        return std::make_unique<HullWorld>(&dispatcher, &broadphase, *contact_solver,
                                           &configuration, *hull_collision, box_slack,
                                           body_settings.linear > 0 || body_settings.angular > 0);
    }

    std::unique_ptr<PhasedWorld> make_bullet_world() {
        if (hull_collision) {
            return nullptr;
        }
        return std::make_unique<PhasedWorld>(&dispatcher, &broadphase, &bullet_solver,
                                             &configuration);
    }
};

std::unique_ptr<BulletWorld> new_world(const WorldDefinition &definition,
                                       rust::Slice<const PairValue> pairs) {
    return std::make_unique<BulletWorld>(definition, pairs);
}

BulletWorld::BulletWorld(const WorldDefinition &definition, rust::Slice<const PairValue> pairs) {
    if (pairs.size() != definition.materials * definition.materials) {
        throw std::runtime_error("the table of pairs is not square in the materials");
    }
    if (definition.threads < 1) {
        throw std::runtime_error("a world is computed by one thread at least");
    }
    const std::lock_guard<std::mutex> lock(construction_mutex());
    impl_ = std::make_unique<Impl>(definition, pairs);
}

BulletWorld::~BulletWorld() {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    impl_.reset();
}

std::uint32_t BulletWorld::add_shape(rust::Slice<const double> coordinates,
                                     rust::Slice<const std::uint32_t> face_starts,
                                     rust::Slice<const std::uint32_t> face_vertices) {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    impl_->shapes.push_back(make_hull(
        impl_->units, polyhedron(coordinates, face_starts, face_vertices), impl_->margin));
    return static_cast<std::uint32_t>(impl_->shapes.size() - 1);
}

std::uint32_t BulletWorld::add_body(const BodyDefinition &definition) {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    if (definition.shape >= impl_->shapes.size() || definition.material >= impl_->materials.count) {
        throw std::runtime_error("a body has a shape or a material that this world has not");
    }
    auto &shape = impl_->shapes[definition.shape];
    const int id = static_cast<int>(impl_->bodies.size());
    const BodyDefinition applied = impl_->stock.applied(impl_->units, definition, *shape);
    impl_->bodies.push_back(make_body(impl_->units, applied, id, shape.get(), &impl_->materials,
                                      impl_->body_settings, impl_->body_pool));
    btRigidBody *body = impl_->bodies.back().get();
    impl_->stock.let_sleep(*body);
    if (definition.kind == BodyKind::Free) {
        impl_->world.addRigidBody(body, Group::FREE, Group::FREE | Group::WALL);
    } else {
        impl_->world.addRigidBody(body, Group::WALL, Group::FREE);
    }
    return static_cast<std::uint32_t>(id);
}

void BulletWorld::remove_body(std::uint32_t id) {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    btRigidBody *body = &impl_->body(id);
    impl_->world.removeRigidBody(body);
    if (impl_->hull_collision) {
        impl_->hull_collision->forget(*body);
    }
    if (impl_->hull_world && impl_->hull_world->followed() == body) {
        impl_->hull_world->follow(nullptr);
    }
    impl_->drives.remove(body);
    impl_->bodies[id].reset();
}

void BulletWorld::drive_body(std::uint32_t id, const std::array<double, 3> &position,
                             const std::array<double, 4> &rotation) {
    // Bullet takes a kinematic body's velocity from the difference to its
    // interpolation pose, which it then moves along (btRigidBody.cpp,
    // saveKinematicState, 3.24).
    const btTransform pose = impl_->units.pose(position, rotation);
    btRigidBody &body = impl_->body(id);
    if (impl_->contact_solver) {
        impl_->drives.add(&body, pose);
    } else {
        impl_->stock.drive(body, pose);
    }
}

void BulletWorld::recall_drive(std::uint32_t id, rust::Slice<const DrivenPose> ends) {
    if (!impl_->body(id).isKinematicObject() || ends.size() != 3) {
        throw std::runtime_error("a body that is driven has three poses before");
    }
    if (!impl_->contact_solver) {
        return; // Bullet's own solver looks at one step alone
    }
    const auto pose = [&](std::size_t i) {
        return impl_->units.pose(ends[i].position, ends[i].rotation);
    };
    impl_->contact_solver->recall_drive(
        static_cast<int>(id),
        recalled_drive({pose(0), pose(1), pose(2)}, static_cast<double>(impl_->time_step)));
}

void BulletWorld::step() {
    if (impl_->hull_world && impl_->hull_world->followed() == nullptr) {
        impl_->hull_world->follow(impl_->drives.first());
    }
    impl_->drives.begin_step();
    // No sub-steps: the step is the one that was asked for.
    impl_->world.stepSimulation(impl_->time_step, 0, impl_->time_step);
    impl_->drives.end_step();
    if (impl_->hull_collision) {
        impl_->hull_collision->recalled.forget();
    }
}

void BulletWorld::read_bodies(rust::Vec<BodyRead> &out) const {
    out.clear();
    out.reserve(impl_->bodies.size());
    for (const auto &body : impl_->bodies) {
        BodyRead read{};
        if (body) {
            const btTransform &pose = body->getWorldTransform();
            read.present = true;
            read.position = impl_->units.metres(pose.getOrigin());
            read.rotation = array(pose.getRotation());
            read.linear_velocity = impl_->units.metres(body->getLinearVelocity());
            read.angular_velocity = array(body->getAngularVelocity());
        }
        out.push_back(read);
    }
}

void BulletWorld::read_corners(rust::Vec<std::uint32_t> &counts,
                               rust::Vec<double> &coordinates) const {
    counts.clear();
    coordinates.clear();
    for (const auto &body : impl_->bodies) {
        counts.push_back(body ? append_corners(impl_->units, *body->getCollisionShape(),
                                               impl_->hull_collision != nullptr, coordinates)
                              : 0);
    }
}

void BulletWorld::read_drives(rust::Vec<DriveRead> &out) const {
    out.clear();
    if (impl_->contact_solver) {
        impl_->contact_solver->read_drives(impl_->units, out);
    }
}

void BulletWorld::read_contacts(rust::Vec<ContactRead> &out) const {
    out.clear();
    if (!impl_->hull_collision) {
        read_manifolds(impl_->units, impl_->dispatcher, out);
        return;
    }
    for (const Touching &pair : impl_->hull_collision->touching) {
        read(impl_->units, pair, out);
    }
}

void BulletWorld::find_contacts() { impl_->world.performDiscreteCollisionDetection(); }

void BulletWorld::remember_contacts(rust::Vec<ContactRead> &out) const {
    out.clear();
    if (!impl_->hull_collision) {
        return; // Bullet's own contacts are not recalled
    }
    for (const Touching &pair : impl_->hull_collision->touching) {
        remember(impl_->units, pair, out);
    }
}

void BulletWorld::recall_contacts(rust::Slice<const ContactRead> contacts) {
    if (impl_->hull_collision) {
        impl_->hull_collision->recalled.take(impl_->units, contacts);
    }
}

PhaseTimes BulletWorld::phases() const {
    const Phases &p = impl_->world.phases();
    return {p.broadphase, p.collision, p.solver, p.integration};
}

double BulletWorld::solver_residual() const {
    return impl_->contact_solver ? impl_->contact_solver->residual() : -1;
}

void BulletWorld::record_substeps(bool on) {
    if (auto *solver = impl_->contact_solver.get()) {
        solver->record(on);
    }
}

void BulletWorld::read_substep(rust::Vec<double> &bodies, rust::Vec<double> &contacts) const {
    const auto *solver = impl_->contact_solver.get();
    (solver ? solver->recorded() : SubstepRecord{}).read(bodies, contacts);
}

PairValue BulletWorld::pair_value(std::uint32_t a, std::uint32_t b) const {
    const btRigidBody &first = impl_->body(a);
    const btRigidBody &second = impl_->body(b);
    // Through the hooks, as Bullet does when it makes a contact.
    return {static_cast<double>(gCalculateCombinedFrictionCallback(&first, &second)),
            static_cast<double>(gCalculateCombinedRestitutionCallback(&first, &second))};
}

rust::Vec<EngineSetting> BulletWorld::effective() const {
    ReadBack out;
    const auto put = [&out](const char *name, double value) { out.put(name, value); };
    const GlobalSettings globals = GlobalsHold::read_back();
    const Units &units = impl_->units;
    const bool relative = (impl_->dispatcher.getDispatcherFlags() &
                           btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD) != 0;
    put("length_scale_units_per_m", units.scale());
    put("time_step_s", static_cast<double>(impl_->time_step));
    if (!impl_->hull_collision) {
        put("contact_breaking_threshold_m", units.metres(globals.contact_breaking_threshold));
    }
    put("broadphase_margin_m", units.metres(globals.broadphase_margin));
    put("relative_contact_threshold",
        relative ? static_cast<double>(globals.contact_breaking_threshold) : 0);
    read_world(units, impl_->world, out);
    if (impl_->hull_collision) {
        const HullCollision &collision = *impl_->hull_collision;
        put("manifold_reach_m", collision.settings.reach / units.scale());
        put("manifold_hysteresis_m", collision.settings.hysteresis / units.scale());
        put("manifold_face_preference_m", collision.settings.face_preference / units.scale());
        put("manifold_hold_m", collision.settings.hold / units.scale());
        put("manifold_match_m", units.metres(collision.match));
        put("box_slack_m", units.metres(impl_->box_slack));
    }
    if (impl_->contact_solver) {
        put("threads", impl_->dispatcher.threads());
        read_solver(units, *impl_->contact_solver, out);
    }
    double lightest = 0;
    for (const auto &body : impl_->bodies) {
        if (body && !body->isStaticOrKinematicObject()) {
            if (lightest == 0) {
                // Every free body is made alike; the first one speaks for all.
                read_body(units, *body, out);
            }
            const double mass = 1 / static_cast<double>(body->getInvMass());
            lightest = lightest == 0 ? mass : std::min(lightest, mass);
        }
    }
    if (lightest > 0) {
        put("lightest_free_body_kg", lightest);
        put("largest_inertia_over_exact", impl_->stock.largest_inertia_ratio());
    }
    return out.take();
}

} // namespace pluvia
