// Implements the functions of the bridge (src/world/bullet/ffi.rs) on a native or a stock world.
#include "world.h"

#include "bodies.h"
#include "convert.h"
#include "globals.h"
#include "native_world.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "shapes.h"
#include "stock_world.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace pluvia {

namespace {

// What only native contacts do.
constexpr const char *PRESSES = "can press a body along one direction";

} // namespace

// Members are destroyed from the last to the first: the world before the bodies
// and shapes that it pointed to.
class BulletWorld::Impl {
  public:
    Impl(const WorldDefinition &of, rust::Slice<const PairValue> pairs)
        : definition(of), units(of.length_scale),
          time_step(static_cast<btScalar>(of.time_step)), materials{of.materials,
                                                                    {pairs.begin(), pairs.end()},
                                                                    {}} {
        if (of.own_collision) {
            auto made = std::make_unique<NativeWorld>(units, of, materials);
            native = made.get();
            world = std::move(made);
        } else {
            world = std::make_unique<StockWorld>(units, of, materials);
        }
        world->setGravity(units.length(of.gravity));
    }

    ~Impl() {
        // Pair by pair: a body that leaves looks through all pairs for its own.
        auto &pairs = *world->getPairCache();
        while (pairs.getNumOverlappingPairs() > 0) {
            const btBroadphasePair last =
                pairs.getOverlappingPairArray()[pairs.getNumOverlappingPairs() - 1];
            pairs.removeOverlappingPair(last.m_pProxy0, last.m_pProxy1, world->getDispatcher());
        }
        for (auto &body : bodies) {
            if (body) {
                world->removeRigidBody(body.get());
            }
        }
    }

    btRigidBody &body(std::uint32_t id) const {
        if (id >= bodies.size() || !bodies[id]) {
            throw std::runtime_error("no body " + std::to_string(id) + " in this world");
        }
        return *bodies[id];
    }

    // The world, where its contacts are native; else throws that only those can do it.
    NativeWorld &native_that(const char *does) const {
        if (native == nullptr) {
            throw std::runtime_error(std::string("only native contacts ") + does);
        }
        return *native;
    }

    WorldDefinition definition;
    Units units;
    btScalar time_step;
    Materials materials;
    std::vector<std::unique_ptr<btConvexInternalShape>> shapes;
    Pool body_pool{sizeof(btRigidBody)};
    std::vector<BodyPtr> bodies;
    std::unique_ptr<EngineWorld> world;
    NativeWorld *native = nullptr; // the same world, where its contacts are native
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

std::uint32_t BulletWorld::add_shape(const ShapeDefinition &definition) {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    impl_->shapes.push_back(make_shape(impl_->units, impl_->definition, definition));
    return static_cast<std::uint32_t>(impl_->shapes.size() - 1);
}

std::uint32_t BulletWorld::add_body(const BodyDefinition &definition) {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    if (definition.shape >= impl_->shapes.size() || definition.material >= impl_->materials.count) {
        throw std::runtime_error("a body has a shape or a material that this world has not");
    }
    auto &shape = impl_->shapes[definition.shape];
    const int id = static_cast<int>(impl_->bodies.size());
    const BodyDefinition applied = impl_->world->applied(definition, *shape);
    impl_->materials.bodies.resize(impl_->bodies.size() + 1);
    impl_->materials.bodies.back() = definition.material;
    impl_->bodies.push_back(
        make_body(impl_->units, impl_->definition, applied, id, shape.get(), impl_->body_pool));
    impl_->world->add(*impl_->bodies.back(), definition.kind);
    return static_cast<std::uint32_t>(id);
}

void BulletWorld::remove_body(std::uint32_t id) {
    const std::lock_guard<std::mutex> lock(construction_mutex());
    impl_->world->remove(impl_->body(id));
    impl_->bodies[id].reset();
}

void BulletWorld::drive_body(std::uint32_t id, const BodyPose &end) {
    impl_->world->drive(impl_->body(id), impl_->units.pose(end));
}

void BulletWorld::recall_drive(std::uint32_t id, rust::Slice<const BodyPose> ends) {
    if (!impl_->body(id).isKinematicObject() || ends.size() != 3) {
        throw std::runtime_error("only a kinematic body is recalled, by three poses");
    }
    const auto pose = [&](std::size_t i) { return impl_->units.pose(ends[i]); };
    if (impl_->native != nullptr) {
        impl_->native->solver().recall_drive(
            static_cast<int>(id),
            recalled_drive({pose(0), pose(1), pose(2)}, static_cast<double>(impl_->time_step)));
    }
}

void BulletWorld::press_body(std::uint32_t id, const PressDefinition &of) {
    btRigidBody &body = impl_->body(id);
    if (!body.isKinematicObject() || !(of.mass > 0)) {
        throw std::runtime_error("a body that is pressed is kinematic and has a mass, or a moment "
                                 "of inertia");
    }
    const double scale = impl_->units.scale();
    Press press;
    press.direction = vector(three(of.direction.data())).normalized();
    press.inverse_mass = 1 / (of.turns ? of.mass * scale * scale : of.mass);
    press.turns = of.turns;
    press.about = impl_->units.length(of.about);
    press.unit = of.turns ? scale * scale : scale;
    impl_->native_that(PRESSES).solver().press(static_cast<int>(id), press);
    if (of.turns) {
        const btVector3 spin = press.direction * static_cast<btScalar>(of.speed);
        body.setAngularVelocity(spin);
        body.setLinearVelocity(spin.cross(body.getWorldTransform().getOrigin() - press.about));
    } else {
        body.setLinearVelocity(press.direction * impl_->units.length(of.speed));
    }
}

void BulletWorld::set_force(std::uint32_t id, double force) {
    impl_->native_that(PRESSES).solver().set_force(impl_->body(id).getUserIndex(), force);
}

void BulletWorld::join_body(std::uint32_t id, std::uint32_t whole) {
    btRigidBody &part = impl_->body(id);
    btRigidBody &of = impl_->body(whole);
    impl_->native_that("have bodies of several parts").join(part, of);
}

void BulletWorld::step(bool alone) {
    if (impl_->native != nullptr) {
        impl_->native->leave_alone(alone);
    }
    impl_->world->step(impl_->time_step);
}

BodyRead BulletWorld::read_one_body(std::uint32_t id) const {
    const btRigidBody &body = impl_->body(id);
    const btTransform &pose = body.getWorldTransform();
    return {true, impl_->units.metres(pose.getOrigin()), array(pose.getRotation()),
            impl_->units.metres(body.getLinearVelocity()), array(body.getAngularVelocity())};
}

void BulletWorld::read_bodies(rust::Vec<BodyRead> &out) const {
    out.clear();
    out.reserve(impl_->bodies.size());
    for (std::size_t id = 0; id < impl_->bodies.size(); ++id) {
        out.push_back(impl_->bodies[id] ? read_one_body(static_cast<std::uint32_t>(id))
                                        : BodyRead{});
    }
}

void BulletWorld::read_corners(rust::Vec<std::uint32_t> &counts, rust::Vec<double> &coordinates,
                               rust::Vec<double> &roundings) const {
    counts.clear();
    coordinates.clear();
    roundings.clear();
    for (const auto &body : impl_->bodies) {
        const Corners corners = body ? append_corners(impl_->units, *body->getCollisionShape(),
                                                      impl_->definition.own_collision, coordinates)
                                     : Corners{0, 0};
        counts.push_back(corners.count);
        roundings.push_back(corners.rounding);
    }
}

void BulletWorld::read_drives(rust::Vec<DriveRead> &out) const {
    out.clear();
    if (impl_->native != nullptr) {
        impl_->native->solver().read_drives(impl_->units, out);
    }
}

void BulletWorld::read_contacts(rust::Vec<ContactRead> &out) const {
    out.clear();
    impl_->world->read_contacts(out);
}

void BulletWorld::find_contacts() {
    impl_->native_that("are found without a step").find_contacts();
}

void BulletWorld::remember_contacts(rust::Vec<ContactRead> &out) const {
    out.clear();
    if (impl_->native != nullptr) {
        impl_->native->remember_contacts(out);
    }
}

void BulletWorld::recall_contacts(rust::Slice<const ContactRead> contacts) {
    if (impl_->native != nullptr) {
        impl_->native->recall_contacts(contacts);
    }
}

PhaseTimes BulletWorld::phases() const { return impl_->world->phases(); }

double BulletWorld::solver_residual() const {
    return impl_->native != nullptr ? impl_->native->solver().residual() : -1;
}

void BulletWorld::record_substeps() {
    if (impl_->native != nullptr) {
        impl_->native->solver().record();
    }
}

void BulletWorld::read_substep(rust::Vec<double> &bodies, rust::Vec<double> &contacts) const {
    bodies.clear();
    contacts.clear();
    if (impl_->native != nullptr) {
        const SubstepRecord &record = impl_->native->solver().recorded();
        std::copy(record.bodies.begin(), record.bodies.end(), std::back_inserter(bodies));
        std::copy(record.contacts.begin(), record.contacts.end(), std::back_inserter(contacts));
    }
}

PairValue BulletWorld::pair_value(std::uint32_t a, std::uint32_t b) const {
    return impl_->world->pair_value(impl_->body(a), impl_->body(b));
}

rust::Vec<EngineSetting> BulletWorld::effective() const {
    ReadBack out;
    const Units &units = impl_->units;
    out.put("length_scale_units_per_m", units.scale());
    out.put("time_step_s", static_cast<double>(impl_->time_step));
    const std::array<double, 3> gravity = units.metres(impl_->world->getGravity());
    out.put("gravity_x_m_per_s2", gravity[0]);
    out.put("gravity_y_m_per_s2", gravity[1]);
    out.put("gravity_z_m_per_s2", gravity[2]);
    impl_->world->read_settings(out);
    double lightest = 0;
    for (const auto &body : impl_->bodies) {
        if (body && !body->isStaticOrKinematicObject()) {
            if (lightest == 0) {
                // Every free body is made alike; the first one speaks for all.
                out.put("linear_damping", body->getLinearDamping());
                out.put("angular_damping", body->getAngularDamping());
                out.put("collision_margin_m", units.metres(body->getCollisionShape()->getMargin()));
                // Whether it sleeps at this moment is no setting; whether it may, is.
                out.put("sleeping", body->getActivationState() != DISABLE_DEACTIVATION);
                impl_->world->read_body(*body, out);
            }
            const double mass = 1 / static_cast<double>(body->getInvMass());
            lightest = lightest == 0 ? mass : std::min(lightest, mass);
        }
    }
    if (lightest > 0) {
        out.put("lightest_free_body_kg", lightest);
        out.put("largest_inertia_over_exact", impl_->world->largest_inertia_ratio());
    }
    return std::move(out.settings);
}

} // namespace pluvia
