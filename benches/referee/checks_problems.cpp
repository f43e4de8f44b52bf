// Checks the referee's solvers on contact problems whose solutions are known.
#include "checks.h"
#include "cone.h"
#include "siconos.h"
#include "solve.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

namespace referee {

namespace {

constexpr double GRAVITY = 9.81, STEP = 1e-3, SIDE = 0.01, MASS = 2.65e-3;

// A column of cubes on a floor, in axes of the floor, under gravity that leans
// by an angle.
Problem column(int count, double angle, double friction, double softness) {
    Problem problem{"column", "none", 0, STEP, {ProblemBody{}}, {}};
    for (int i = 0; i < count; ++i) {
        ProblemBody body;
        body.inverse_mass = 1 / MASS;
        body.inverse_inertia = Mat3::Identity() * 6 / (MASS * SIDE * SIDE);
        body.free.head<3>() = STEP * GRAVITY * Vec3(std::sin(angle), 0, -std::cos(angle));
        problem.bodies.push_back(body);
        for (int corner = 0; corner < 4; ++corner) {
            ProblemContact c;
            c.a = i + 1;
            c.b = i;
            const double x = (corner & 1) != 0 ? 0.5 : -0.5, y = (corner & 2) != 0 ? 0.5 : -0.5;
            c.set_geometry(Vec3::UnitZ(), SIDE * Vec3(x, y, -0.5), SIDE * Vec3(x, y, 0.5));
            c.friction = friction;
            c.softness = softness;
            problem.contacts.push_back(c);
        }
    }
    return problem;
}

Solution solved(const System &system, const Limits &limits = {}) {
    return solve(system, Impulses(system.rows.size(), Vec3::Zero()), limits);
}

double largest(const Problem &problem, const Motion &scaled_velocities) {
    double most = 0;
    for (const Vec6 &v : unscaled(problem, scaled_velocities)) {
        most = std::max(most, v.norm());
    }
    return most;
}

void check_one_contact(Checks &checks) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    double worst = 0;
    int kinds[3] = {0, 0, 0};
    for (int n = 0; n < 3000; ++n) {
        Mat3 root;
        Vec3 q;
        for (int i = 0; i < 3; ++i) {
            q[i] = normal(random);
            for (int j = 0; j < 3; ++j) {
                root(i, j) = normal(random);
            }
        }
        const Mat3 w = root * root.transpose() + 0.05 * Mat3::Identity();
        const double friction = std::abs(normal(random));
        double alpha = 0;
        const Vec3 impulse = solve_contact(w, w.inverse(), q, friction, alpha);
        const Vec3 u = w * impulse + q;
        const double scale = impulse.norm() + u.norm();
        worst = std::max(worst, (impulse - natural_map(impulse, u, friction, 1)).norm() / scale);
        // De Saxcé's form of the same law, by another projection.
        const Vec3 shifted = u + Vec3(friction * u.tail<2>().norm(), 0, 0);
        worst = std::max(worst, (impulse - onto_cone(impulse - shifted, friction)).norm() / scale);
        ++kinds[impulse[0] == 0 ? 0 : (u.norm() < 1e-9 * scale ? 1 : 2)];
    }
    checks.equal("what pulls without friction lies outside the cone",
                 onto_cone({-1, 0, 0}, 0).norm(), 0, 0);
    checks.equal("what presses without friction inside", onto_cone({1, 0, 0}, 0)[0], 1, 0);
    checks.below("law at one contact, 3000 random ones", worst, 1e-10);
    checks.above("of which part, stick and slide at least", *std::min_element(kinds, kinds + 3),
                 300);
}

void check_slope(Checks &checks) {
    for (const double softness : {0.0, 1.0}) {
        const double angle = 0.5, critical = std::tan(angle);
        const Problem holds = column(1, angle, 1.001 * critical, 0);
        const Solution still = solved(scaled(holds));
        checks.below("residual of a block that holds", still.residual, 1e-10);
        checks.below("its velocity, m/s", largest(holds, still.motion), 1e-10);
        const double friction = 0.8 * critical;
        const Problem slides = column(1, angle, friction, softness);
        const Solution s = solved(scaled(slides));
        checks.below("residual of a block that slides", s.residual, 1e-10);
        const Vec6 v = unscaled(slides, s.motion)[1];
        if (softness == 0) {
            const double expected = STEP * GRAVITY * (std::sin(angle) - friction * std::cos(angle));
            checks.equal("velocity of a block that slides", v[0], expected, 1e-12);
            // A cone of velocities instead of Coulomb's law would lift it.
            checks.equal("it does not lift off", v[2], 0, 1e-12);
        } else {
            double load = 0;
            for (const Vec3 &l : s.impulses) {
                load += l[0];
            }
            const double change = v[2] + STEP * GRAVITY * std::cos(angle);
            checks.equal("a soft contact carries what it stops", load / MASS, change, 1e-12);
            checks.below("and gives way", v[2], -1e-6);
        }
    }
}

void check_column(Checks &checks) {
    const int count = 10;
    const Problem problem = column(count, 0, 0.5, 0);
    const Solution s = solved(scaled(problem));
    checks.below("residual of a column of ten", s.residual, 1e-10);
    checks.below("its largest velocity, m/s", largest(problem, s.motion), 1e-9);
    for (int i = 0; i < count; ++i) {
        double load = 0;
        for (int corner = 0; corner < 4; ++corner) {
            load += s.impulses[static_cast<std::size_t>(4 * i + corner)][0];
        }
        checks.equal("load in the column", load / (MASS * GRAVITY * STEP), count - i, 1e-8);
    }
}

// Two cubes: one flies into the other, face to face, without friction.
void check_impact(Checks &checks) {
    Problem problem = column(2, M_PI / 2, 0, 0);
    problem.contacts.erase(problem.contacts.begin(), problem.contacts.begin() + 4);
    problem.bodies[1].free.setZero();
    problem.bodies[2].free << 0, 0, -2, 0, 0, 0;
    const Solution s = solved(scaled(problem));
    for (const std::size_t body : {1, 2}) {
        checks.equal("after a plastic impact both go on together",
                     unscaled(problem, s.motion)[body][2], -1, 1e-10);
    }
    problem.bodies[2].free[2] = 2;
    const Solution apart = solved(scaled(problem));
    checks.equal("what parts is left alone", unscaled(problem, apart.motion)[2][2], 2, 0);
}

// What is wrong must be called wrong, and by how much.
void check_wrong(Checks &checks) {
    Problem problem = column(5, 0.45, 0.4, 0.5);
    const System system = scaled(problem);
    const Solution s = solved(system);
    checks.below("residual of a leaning column", s.residual, 1e-10);
    Impulses wrong = s.impulses;
    wrong[3] *= 1.01;
    checks.above("residual with one impulse 1 % too large",
                 residual(system, wrong, system.motion(wrong)), 1e-4);
    wrong = s.impulses;
    for (Vec3 &impulse : wrong) {
        impulse.tail<2>().setZero();
    }
    checks.above("residual without friction", residual(system, wrong, system.motion(wrong)), 0.1);
    checks.above("residual without impulses",
                 residual(system, Impulses(wrong.size(), Vec3::Zero()), system.free), 0.1);
    Problem frictionless = problem;
    for (ProblemContact &c : frictionless.contacts) {
        c.friction = 0.2;
    }
    const Solution other = solved(scaled(frictionless));
    checks.above("residual of the solution for half the friction",
                 residual(system, other.impulses, other.motion), 0.05);
    checks.below("errors of the solution itself", body_errors(system, s.motion, s.motion)[0], 0);
    // All of one body's change missed: its error is its own change over the mean.
    Motion found = s.motion;
    found[2] = system.free[2];
    const std::vector<double> errors = body_errors(system, s.motion, found);
    double squares = 0;
    for (std::size_t i = 1; i < found.size(); ++i) {
        squares += (s.motion[i] - system.free[i]).squaredNorm() / 5;
    }
    checks.equal("bodies that are compared", static_cast<double>(errors.size()), 5, 0);
    checks.equal("error of a body that was forgotten", errors[1],
                 (s.motion[2] - system.free[2]).norm() / std::sqrt(squares), 1e-12);
}

void check_files(Checks &checks) {
    const Problem problem = column(3, 0.3, 0.4, 0.25);
    std::ostringstream text;
    write_problem(problem, text);
    const Problem read = read_problem(text.str());
    const System one = scaled(problem), other = scaled(read);
    double worst = distance(one.free, other.free);
    for (std::size_t i = 0; i < one.rows.size(); ++i) {
        worst += (one.rows[i].delassus - other.rows[i].delassus).norm();
        worst += (one.rows[i].ja - other.rows[i].ja).norm();
    }
    checks.equal("a problem written and read is the same", worst, 0, 0);
}

// Siconos solves what it can; where it does, velocities agree.
void check_siconos(Checks &checks) {
    for (const double angle : {0.1, 0.5}) {
        const System system = scaled(column(4, angle, 0.4, 0.5));
        const Solution ours = solved(system);
        checks.below("Siconos' error of the referee's solution",
                     siconos_error(system, ours.impulses), 1e-7);
        const Impulses zero(system.rows.size(), Vec3::Zero());
        const Solution theirs = solve_with_siconos(system, zero, 1e-12, 100000);
        checks.below("the referee's residual of Siconos' solution", theirs.residual, 1e-7);
        checks.below("velocities of Siconos and the referee",
                     distance(ours.motion, theirs.motion) / distance(ours.motion, system.free),
                     1e-6);
        Impulses wrong = ours.impulses;
        for (Vec3 &impulse : wrong) {
            impulse *= 1.01;
        }
        checks.above("Siconos' error of a wrong one", siconos_error(system, wrong), 1e-4);
    }
}

} // namespace

void check_problems(Checks &checks) {
    check_one_contact(checks);
    check_slope(checks);
    check_column(checks);
    check_impact(checks);
    check_wrong(checks);
    check_files(checks);
    check_siconos(checks);
}

} // namespace referee
