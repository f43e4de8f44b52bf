// Checks the referee's time stepping and its law of impact on motions that are known.
#include "checks.h"
#include "pour.h"
#include "restitution.h"

#include <algorithm>
#include <cmath>

namespace referee {

namespace {

constexpr double DENSITY = 2650, GRAVITY = 9.81;

// The native solver's rule for the paper's gravel: at the threshold a body goes 1.4 µm in a
// sub-step of 1/1440 s, and is met at half of it.
ImpactRule native_rule(double restitution) { return {restitution, 0.002, 1e-5, 0.002 / 1440 / 2}; }

Grain box(const Vec3 &sides, const Vec3 &position) {
    Grain grain;
    grain.hull = Hull::box(sides);
    grain.mass = DENSITY * sides.prod();
    const Vec3 squares = sides.cwiseProduct(sides);
    grain.inertia = grain.mass / 12 * (Vec3::Constant(squares.sum()) - squares);
    grain.position = position;
    grain.rotation = Quat::Identity();
    return grain;
}

Scene on_a_floor(std::vector<Grain> grains, double friction, double restitution = 0) {
    Scene scene;
    scene.grains = std::move(grains);
    scene.walls = {{Vec3::UnitZ(), 0}};
    scene.set_friction(friction);
    scene.restitution = restitution;
    scene.restitution_threshold = 0.002;
    return scene;
}

PourSettings settings(double step, double duration) {
    PourSettings s;
    s.step = step;
    s.duration = duration;
    s.limits = {1e-8, 500, Limits{}.newton_steps};
    s.rest_speed = 0;
    return s;
}

void check_flight(Checks &checks) {
    const double step = 1e-3, duration = 0.2;
    Grain grain = box({0.01, 0.012, 0.017}, {0, 0, 1});
    grain.spin = {20, 3, -7};
    Scene scene = on_a_floor({grain}, 0.5);
    Pour pour(scene, settings(step, duration), forces_only);
    pour.run();
    const Grain &end = pour.scene().grains[0];
    const double n = duration / step;
    checks.equal("free fall in steps", end.position.z(),
                 1 - GRAVITY * step * step * n * (n + 1) / 2, 1e-12);
    const auto momentum = [](const Grain &g) {
        return Vec3(g.rotation * g.inertia.cwiseProduct(g.rotation.inverse() * g.spin));
    };
    checks.below("change of angular momentum in flight",
                 (momentum(end) - momentum(grain)).norm() / momentum(grain).norm(), 1e-12);
    scene.gravity.setZero();
    Pour turning(scene, settings(step, duration), forces_only);
    const double before = turning.energy();
    turning.run();
    checks.below("change of energy in turning", std::abs(turning.energy() / before - 1), 2e-3);
}

void check_slide(Checks &checks) {
    const double angle = 0.5, duration = 0.3;
    for (const double ratio : {1.01, 0.7}) {
        const double friction = ratio * std::tan(angle);
        Scene scene = on_a_floor({box({0.02, 0.02, 0.01}, {0, 0, 0.005})}, friction);
        scene.gravity = GRAVITY * Vec3(std::sin(angle), 0, -std::cos(angle));
        const double step = 2e-4;
        Pour pour(scene, settings(step, duration), forces_only);
        pour.run();
        const double acceleration =
            ratio > 1 ? 0 : GRAVITY * (std::sin(angle) - friction * std::cos(angle));
        const Grain &end = pour.scene().grains[0];
        checks.equal("displacement of a block on a slope", end.position.x(),
                     acceleration * duration * (duration + step) / 2, 3e-6);
        checks.equal("its height", end.position.z(), 0.005, 1e-5);
        checks.below("its turn", end.spin.norm(), 1e-6);
    }
}

void check_column(Checks &checks) {
    std::vector<Grain> grains;
    for (int i = 0; i < 5; ++i) {
        grains.push_back(box({0.01, 0.01, 0.01}, {1e-4 * i, 0, 0.006 + 0.012 * i}));
    }
    PourSettings s = settings(5e-4, 0.5);
    s.rest_speed = 1e-4;
    Pour pour(on_a_floor(grains, 0.5), s, forces_only);
    const PourRecord record = pour.run();
    checks.above("a column comes to rest", record.at_rest, 1);
    checks.below("before the time is over", record.simulated, 0.5 - 1e-9);
    checks.below("energy gained on the way", record.energy_gain, 0.02);
    checks.equal("height of its top", pour.scene().grains[4].position.z(), 0.045, 1e-5);
    checks.equal("grains that touch each other", measure(pour.scene(), 5e-5).coordination, 8.0 / 5,
                 1e-12);
    checks.below("share of steps left unsolved", record.unsolved, 0.02);
}

// A fast block must not pass through a thin one.
void check_tunnel(Checks &checks) {
    std::vector<Grain> grains = {box({0.03, 0.03, 0.001}, {0, 0, 0.0005}),
                                 box({0.01, 0.01, 0.01}, {0, 0, 0.05})};
    grains[1].velocity = {0, 0, -20};
    Pour pour(on_a_floor(grains, 0.5), settings(1e-3, 0.02), forces_only);
    pour.run();
    checks.above("a fast block stays above a thin one", pour.scene().grains[1].position.z(),
                 0.0059);
}

// Blocks that fall flat part with e times their speed, whatever the step.
void check_rebound(Checks &checks) {
    for (const double e : {0.3, 0.9}) {
        for (const double step : {1e-3, 7e-4}) {
            Scene scene = on_a_floor({box({0.01, 0.01, 0.01}, {0, 0, 0.0263})}, 0.5, e);
            Pour pour(scene, settings(step, 1), compression_and_restitution(native_rule(e)));
            double lowest = 0, highest = 0;
            for (int n = 0; n * step < 0.09; ++n) {
                pour.step();
                lowest = std::min(lowest, pour.scene().grains[0].velocity.z());
                highest = std::max(highest, pour.scene().grains[0].velocity.z());
            }
            checks.equal("rebound over approach", -highest / lowest, e, 1e-6);
        }
    }
}

// Two boxes in flight, the one turning with some `spin` in rad/s; another pair for each n.
Scene boxes_that_meet(int n, double spin, double friction, double restitution) {
    std::vector<Grain> grains = {box({0.01, 0.012, 0.015}, {0, 0, 0}),
                                 box({0.013, 0.011, 0.01}, {0.002, 0.001, 0.02})};
    grains[1].rotation = Quat(Eigen::AngleAxisd(0.7 * n, Vec3(1, 0.3 * n, 2).normalized()));
    grains[1].velocity = {0.3 * std::sin(n), 0.3 * std::cos(3.0 * n), -1};
    grains[0].spin = spin * Vec3(std::sin(2.0 * n), 1, -0.6);
    Scene scene = on_a_floor(grains, friction, restitution);
    scene.walls.clear();
    scene.gravity.setZero();
    return scene;
}

// Momentum stays, energy falls, in oblique impacts with friction and turns.
void check_oblique(Checks &checks) {
    double worst_momentum = 0, most_gain = -1, parted = 0;
    for (int n = 0; n < 40; ++n) {
        const Scene scene = boxes_that_meet(n, 5, 0.6, 0.5);
        Pour pour(scene, settings(2e-4, 0.03), compression_and_restitution(native_rule(0.5)));
        const auto momentum = [&] {
            Vec3 sum = Vec3::Zero();
            for (const Grain &g : pour.scene().grains) {
                sum += g.mass * g.velocity;
            }
            return sum;
        };
        const Vec3 before = momentum();
        const double energy = pour.energy();
        pour.run();
        worst_momentum = std::max(worst_momentum, (momentum() - before).norm() / before.norm());
        most_gain = std::max(most_gain, pour.energy() / energy - 1);
        parted += pour.energy() < 0.98 * energy;
    }
    checks.below("change of momentum in oblique impacts", worst_momentum, 1e-12);
    checks.below("energy gained in oblique impacts", most_gain, 2e-4);
    checks.above("oblique impacts that took place", parted, 20);
}

// Turning boxes that fly into each other, at rigid contacts: corners and edges that come
// in during a step must not be missed. With one look at each step they are.
void check_unforeseen(Checks &checks) {
    for (const bool again : {true, false}) {
        double deepest = 0;
        for (int n = 0; n < 40; ++n) {
            PourSettings s = settings(5e-4, 0.03);
            s.stiffness = 1e8;
            s.most_looks = again ? s.most_looks : 1;
            Pour pour(boxes_that_meet(n, 50, 0, 0), s, forces_only);
            for (int k = 0; k < 60; ++k) {
                pour.step();
                deepest = std::max(deepest, measure(pour.scene(), 0).deepest_overlap);
            }
        }
        if (again) {
            checks.below("overlap of boxes that fly into each other, m", deepest, 2e-5);
        } else {
            checks.above("overlap with one look at each step, m", deepest, 1e-4);
        }
    }
}

// Velocity after one step of a block that falls flat, corners `gap` above the floor.
double fallen_flat(double speed, double gap, const Law &law) {
    Scene scene = on_a_floor({box({0.01, 0.01, 0.01}, {0, 0, 0.005 + gap})}, 0.5);
    scene.grains[0].velocity = {0, 0, -speed};
    scene.gravity.setZero();
    Pour pour(scene, settings(5e-4, 1), law);
    pour.step();
    return pour.scene().grains[0].velocity.z();
}

// What counts as an impact, and that nothing of the approach is left without restitution.
void check_impacts(Checks &checks) {
    const double speed = 0.02, step = 5e-4, displacement = speed * step;
    for (const double e : {0.0, 0.4}) {
        const Law law = compression_and_restitution(native_rule(e));
        checks.equal("a block that meets the floor", fallen_flat(1, 1e-4, law), e, 1e-7);
        checks.equal("one that bears nothing and ends 0.5 µm off is an impact",
                     fallen_flat(speed, displacement + 5e-7, law), e * speed, 1e-9);
        checks.equal("one that ends 5 µm off is none", fallen_flat(speed, displacement + 5e-6, law),
                     -speed, 1e-9);
        checks.equal("one that ends beyond the closed gap",
                     fallen_flat(speed, displacement + 1.2e-5, law), -speed, 1e-9);
        checks.equal("one slower than the threshold",
                     fallen_flat(0.0019, 0.0019 * step + 5e-7, law), -0.0019, 1e-9);
    }
    checks.below("forces alone let the contact give way", fallen_flat(1, 1e-4, forces_only), -0.01);
}

} // namespace

void check_stepping(Checks &checks) {
    check_unforeseen(checks);
    check_impacts(checks);
    check_flight(checks);
    check_slide(checks);
    check_column(checks);
    check_tunnel(checks);
    check_rebound(checks);
    check_oblique(checks);
}

} // namespace referee
