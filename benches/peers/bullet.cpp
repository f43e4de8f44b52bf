// Stock Bullet: a scene in a stock btDiscreteDynamicsWorld, with the settings
// that docs/peers.md gives reasons for.
//
//   bullet SCENE.json RESULT.json RATE_HZ ITERATIONS SECONDS LIMIT_S
#include "peer.h"

#include <btBulletDynamicsCommon.h>

#include <memory>

extern btScalar gContactBreakingThreshold;

namespace {

// Bullet's tolerances are absolute and made for bodies of about one unit.
constexpr double SCALE = 100;
constexpr double CONTACT_THRESHOLD = 1e-3; // m

btVector3 length(const json::Value &v) {
    return {static_cast<btScalar>(SCALE * v.at(0)), static_cast<btScalar>(SCALE * v.at(1)),
            static_cast<btScalar>(SCALE * v.at(2))};
}

btTransform pose(const json::Value &body) {
    const auto &q = body["quaternion_xyzw"];
    const auto part = [&](int i) { return static_cast<btScalar>(q.at(i)); };
    return btTransform(btQuaternion(part(0), part(1), part(2), part(3)),
                       length(body["position_m"]));
}

std::unique_ptr<btConvexHullShape> hull(const json::Value &body) {
    auto shape = std::make_unique<btConvexHullShape>();
    shape->setMargin(0); // before the box is computed, which keeps the margin of that moment
    for (const auto &v : body["vertices_m"].list) {
        shape->addPoint(length(v), false);
    }
    shape->recalcLocalAabb();
    return shape;
}

struct Laboratory {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<btConvexHullShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<btRigidBody *> grains;
    std::vector<std::pair<btRigidBody *, btVector3>> on_table;
    // Bullet multiplies the values of the two bodies.
    struct Surface {
        double friction = 0, restitution = 0;
    } grain, wall, plate;

    ~Laboratory() {
        for (auto &body : bodies) {
            world.removeRigidBody(body.get());
        }
    }

    void settings(const json::Value &scene, int iterations) {
        gContactBreakingThreshold = static_cast<btScalar>(SCALE * CONTACT_THRESHOLD);
        dispatcher.setDispatcherFlags(
            dispatcher.getDispatcherFlags() &
            ~btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD);
        world.setGravity(length(scene["gravity_m_per_s2"]));
        auto &info = world.getSolverInfo();
        info.m_numIterations = iterations;
        info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
        info.m_splitImpulse = 0;
        for (const auto &pair : scene["pairs"].list) {
            const auto &between = pair["between"].list;
            const double f = pair["friction"].number, e = pair["restitution"].number;
            if (between.at(0).text != "grain") {
                continue; // plate on wall: no product of what the others fix
            }
            if (between.at(1).text == "grain") {
                grain = {std::sqrt(f), std::sqrt(e)};
            } else {
                (between.at(1).text == "wall" ? wall : plate) = {f / grain.friction,
                                                                 e / grain.restitution};
            }
        }
    }

    btRigidBody &add(const json::Value &what, const Surface &surface) {
        const bool free = what.fields.count("mass_kg") > 0;
        const double mass = free ? what["mass_kg"].number : 0;
        // Moments in kg m²: the scale comes in twice.
        const btVector3 inertia = free
                                      ? length(what["inertia_kg_m2"]) * static_cast<btScalar>(SCALE)
                                      : btVector3(0, 0, 0);
        shapes.push_back(hull(what));
        btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr,
                                                      shapes.back().get(), inertia);
        info.m_startWorldTransform = pose(what);
        info.m_friction = static_cast<btScalar>(surface.friction);
        info.m_restitution = static_cast<btScalar>(surface.restitution);
        bodies.push_back(std::make_unique<btRigidBody>(info));
        btRigidBody &body = *bodies.back();
        body.setActivationState(DISABLE_DEACTIVATION);
        if (free) {
            body.setLinearVelocity(length(what["linear_velocity_m_per_s"]));
            const auto &w = what["angular_velocity_rad_per_s"];
            body.setAngularVelocity({static_cast<btScalar>(w.at(0)), static_cast<btScalar>(w.at(1)),
                                     static_cast<btScalar>(w.at(2))});
        }
        return body;
    }

    void build(const json::Value &scene) {
        const btVector3 middle(static_cast<btScalar>(SCALE * scene["table"]["x_m"].number), 0, 0);
        for (const auto &piece : scene["apparatus"].list) {
            btRigidBody &body = add(piece, wall);
            if (piece["motion"].text == "table") {
                body.setCollisionFlags(body.getCollisionFlags() |
                                       btCollisionObject::CF_KINEMATIC_OBJECT);
                on_table.emplace_back(&body, body.getWorldTransform().getOrigin() - middle);
            }
            world.addRigidBody(&body);
        }
        for (const auto &grain : scene["grains"].list) {
            btRigidBody &body = add(grain, this->grain);
            world.addRigidBody(&body);
            grains.push_back(&body);
        }
        if (!scene["top_plate"].null()) {
            world.addRigidBody(&add(scene["top_plate"], plate));
        }
    }

    void drive(double x, double) {
        for (auto &[body, at_rest] : on_table) {
            btTransform end = body->getWorldTransform();
            end.setOrigin(at_rest + btVector3(static_cast<btScalar>(SCALE * x), 0, 0));
            body->setWorldTransform(end);
        }
    }

    void step(double length) { world.stepSimulation(static_cast<btScalar>(length), 0); }

    std::vector<peer::Pose> poses() const {
        std::vector<peer::Pose> out;
        for (const btRigidBody *grain : grains) {
            const btVector3 p = grain->getWorldTransform().getOrigin();
            const btQuaternion q = grain->getWorldTransform().getRotation();
            out.push_back(
                {{p.x() / SCALE, p.y() / SCALE, p.z() / SCALE}, {q.x(), q.y(), q.z(), q.w()}});
        }
        return out;
    }
};

void run(char **argv) {
    const peer::Job job(argv);
    Laboratory lab;
    lab.settings(job.scene, job.iterations);
    lab.build(job.scene);
    const std::string version = std::to_string(btGetVersion() / 100) + '.' +
                                std::to_string(btGetVersion() % 100) +
                                (sizeof(btScalar) == 8 ? " double" : " single");
    peer::carry(job, version, lab);
}

} // namespace

int main(int argc, char **argv) {
    return peer::main(argc, argv, 6,
                      "bullet SCENE.json RESULT.json RATE_HZ ITERATIONS SECONDS LIMIT_S", run);
}
