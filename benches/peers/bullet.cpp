// Bare Bullet: a scene in a stock btDiscreteDynamicsWorld, with the settings
// that docs/peers.md gives reasons for.
//
//   bullet SCENE.json RESULT.json RATE_HZ ITERATIONS SECONDS LIMIT_S
#include "json.h"

#include <btBulletDynamicsCommon.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <sys/resource.h>

extern btScalar gContactBreakingThreshold;

namespace {

// Bullet's tolerances are absolute and made for bodies of about one unit.
constexpr double SCALE = 100;
constexpr double CONTACT_THRESHOLD = 1e-3; // m
constexpr double SAMPLE = 0.08;            // s

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

struct Law {
    double amplitude = 0, frequency = 0, duration = 0, rest = 0, total = 0;
    double x(double time) const {
        if (time < 0 || time >= total) {
            return 0;
        }
        const double t = std::fmod(time, duration + rest);
        return t < duration ? amplitude * std::sin(2 * M_PI * frequency * t) : 0;
    }
};

Law law(const json::Value &motion) {
    Law l;
    if (!motion.null()) {
        l.amplitude = motion["amplitude_m"].number;
        l.frequency = motion["frequency_hz"].number;
        l.duration = motion["duration_s"].number;
        l.rest = motion["rest_s"].number;
        l.total = motion["periods"].number * (l.duration + l.rest) - l.rest;
    }
    return l;
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

    void drive(double x) {
        for (auto &[body, at_rest] : on_table) {
            btTransform end = body->getWorldTransform();
            end.setOrigin(at_rest + btVector3(static_cast<btScalar>(SCALE * x), 0, 0));
            body->setWorldTransform(end);
        }
    }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void run(char **argv) {
    const json::Value scene = json::read(argv[1]);
    const double rate = std::atof(argv[3]), seconds = std::atof(argv[5]);
    const double limit = std::atof(argv[6]);
    const int iterations = std::atoi(argv[4]);
    Laboratory lab;
    lab.settings(scene, iterations);
    lab.build(scene);
    const Law table = law(scene["table"]["motion"]);

    std::ostringstream series;
    series.precision(10);
    const auto sample = [&](double time) {
        series << (series.tellp() > 0 ? "," : "") << "{\"time_s\":" << time << ",\"z_m\":[";
        for (std::size_t i = 0; i < lab.grains.size(); ++i) {
            series << (i ? "," : "") << lab.grains[i]->getWorldTransform().getOrigin().z() / SCALE;
        }
        series << "]}";
    };
    sample(0);
    const double dt = 1 / rate;
    const long last = std::lround(seconds * rate);
    double wall = 0, next = SAMPLE, x = scene["table"]["x_m"].number;
    long step = 0;
    while (step < last && wall < limit) {
        const auto start = std::chrono::steady_clock::now();
        ++step;
        if (table.total > 0) {
            x = table.x(step * dt);
            lab.drive(x);
        }
        lab.world.stepSimulation(static_cast<btScalar>(dt), 0);
        wall += seconds_since(start);
        if (step * dt >= next - dt / 2 || step == last) {
            next += SAMPLE;
            sample(step * dt);
        }
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::ofstream out(argv[2]);
    out.precision(17);
    out << "{\"version\":\"" << btGetVersion() / 100 << '.' << btGetVersion() % 100
        << (sizeof(btScalar) == 8 ? " double" : " single") << "\",\"steps\":" << step
        << ",\"simulated_s\":" << step * dt << ",\"wall_s\":" << wall
        << ",\"peak_memory_mib\":" << static_cast<double>(usage.ru_maxrss) / 1024
        << ",\"table_x_m\":" << x << ",\"poses\":[";
    for (std::size_t i = 0; i < lab.grains.size(); ++i) {
        const btTransform &t = lab.grains[i]->getWorldTransform();
        const btVector3 p = t.getOrigin();
        const btQuaternion q = t.getRotation();
        out << (i ? "," : "") << '[' << p.x() / SCALE << ',' << p.y() / SCALE << ','
            << p.z() / SCALE << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << q.w() << ']';
    }
    out << "],\"series\":[" << series.str() << "]}\n";
    if (!out.flush()) {
        throw std::runtime_error(std::string("cannot write ") + argv[2]);
    }
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 7) {
        std::cerr << "usage: bullet SCENE.json RESULT.json RATE_HZ ITERATIONS SECONDS LIMIT_S\n";
        return 2;
    }
    try {
        run(argv);
    } catch (const std::exception &error) {
        std::cerr << "error: " << error.what() << '\n';
        return 1;
    }
    return 0;
}
