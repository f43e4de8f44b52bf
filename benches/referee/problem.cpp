// Reads a contact problem, brings it into the coordinates of its kinetic norm, and measures how
// well impulses solve it.
#include "problem.h"

#include "cone.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <ostream>
#include <stdexcept>

namespace referee {

namespace {

using nlohmann::json;

// Change of the motion, over the motion, below which contacts do nothing.
constexpr double NEGLIGIBLE = 1e-6;

Vec3 three(const json &list, std::size_t at) {
    return {list.at(at).get<double>(), list.at(at + 1).get<double>(),
            list.at(at + 2).get<double>()};
}

void put(json &list, const Eigen::Ref<const Eigen::VectorXd> &values) {
    for (const double value : values) {
        list.push_back(value);
    }
}

// From velocities to scaled ones.
Vec6 scale_up(const ProblemBody &body, const Vec6 &velocity) {
    Vec6 w = Vec6::Zero();
    if (body.inverse_mass > 0) {
        w.head<3>() = velocity.head<3>() / std::sqrt(body.inverse_mass);
        w.tail<3>() = symmetric_root(body.inverse_inertia).inverse() * velocity.tail<3>();
    }
    return w;
}

} // namespace

Problem read_problem(const std::string &line) {
    const json read = json::parse(line);
    Problem problem;
    problem.scene = read.at("scene").get<std::string>();
    problem.engine = read.at("engine").get<std::string>();
    problem.time = read.at("time_s").get<double>();
    problem.step = read.at("step_s").get<double>();
    for (const json &b : read.at("bodies")) {
        ProblemBody body;
        body.inverse_mass = b.at(0).get<double>();
        const Vec3 diagonal = three(b, 1), rest = three(b, 4);
        body.inverse_inertia << diagonal.x(), rest.x(), rest.y(), //
            rest.x(), diagonal.y(), rest.z(),                     //
            rest.y(), rest.z(), diagonal.z();
        body.free << three(b, 7), three(b, 10);
        body.found << three(b, 13), three(b, 16);
        problem.bodies.push_back(body);
    }
    const auto count = static_cast<int>(problem.bodies.size());
    for (const json &c : read.at("contacts")) {
        ProblemContact contact;
        contact.a = c.at(0).get<int>();
        contact.b = c.at(1).get<int>();
        if (std::min(contact.a, contact.b) < 0 || std::max(contact.a, contact.b) >= count) {
            throw std::runtime_error("a contact names a body that is not in the problem");
        }
        for (int k = 0; k < 3; ++k) {
            const auto at = static_cast<std::size_t>(2 + 9 * k);
            contact.axes.row(k) = three(c, at);
            contact.moments_a.row(k) = three(c, at + 3);
            contact.moments_b.row(k) = three(c, at + 6);
        }
        contact.friction = c.at(29).get<double>();
        contact.target = c.at(30).get<double>();
        contact.softness = c.at(31).get<double>();
        contact.found = three(c, 32);
        problem.contacts.push_back(contact);
    }
    return problem;
}

void write_problem(const Problem &problem, std::ostream &out) {
    json bodies = json::array(), contacts = json::array();
    for (const ProblemBody &b : problem.bodies) {
        const Mat3 &i = b.inverse_inertia;
        json row = {b.inverse_mass, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)};
        put(row, b.free);
        put(row, b.found);
        bodies.push_back(row);
    }
    for (const ProblemContact &c : problem.contacts) {
        json row = {c.a, c.b};
        for (int k = 0; k < 3; ++k) {
            for (const Mat3 *m : {&c.axes, &c.moments_a, &c.moments_b}) {
                put(row, m->row(k).transpose());
            }
        }
        row.insert(row.end(), {c.friction, c.target, c.softness});
        put(row, c.found);
        contacts.push_back(row);
    }
    out << json{{"scene", problem.scene}, {"engine", problem.engine}, {"time_s", problem.time},
                {"step_s", problem.step}, {"bodies", bodies},         {"contacts", contacts}}
        << '\n';
}

void ProblemContact::set_geometry(const Vec3 &normal, const Vec3 &arm_a, const Vec3 &arm_b) {
    Vec3 first, second;
    tangents_of(normal, first, second);
    axes << normal.transpose(), first.transpose(), second.transpose();
    for (int k = 0; k < 3; ++k) {
        const Vec3 axis = axes.row(k);
        moments_a.row(k) = arm_a.cross(axis);
        moments_b.row(k) = arm_b.cross(axis);
    }
}

System scaled(const Problem &problem) {
    System system;
    std::vector<Mat3> roots;
    for (const ProblemBody &b : problem.bodies) {
        roots.push_back(symmetric_root(b.inverse_inertia));
    }
    system.free = scaled_motion(problem, false);
    for (const ProblemContact &c : problem.contacts) {
        Row row;
        row.delassus = Vec3(c.softness, 0, 0).asDiagonal();
        row.fixed = Vec3(-c.target, 0, 0);
        const auto side = [&](int number, const Mat3 &moments, double sign, Mat36 &jacobian) {
            const ProblemBody &body = problem.bodies[static_cast<std::size_t>(number)];
            Mat36 plain;
            plain << sign * c.axes, sign * moments;
            if (body.inverse_mass <= 0) {
                row.fixed += plain * body.free;
                return -1;
            }
            jacobian.leftCols<3>() = plain.leftCols<3>() * std::sqrt(body.inverse_mass);
            jacobian.rightCols<3>() =
                plain.rightCols<3>() * roots[static_cast<std::size_t>(number)];
            row.delassus += jacobian * jacobian.transpose();
            return number;
        };
        row.a = side(c.a, c.moments_a, 1, row.ja);
        row.b = side(c.b, c.moments_b, -1, row.jb);
        row.friction = c.friction;
        row.softness = c.softness;
        system.rows.push_back(row);
    }
    return system;
}

Motion scaled_motion(const Problem &problem, bool found) {
    Motion motion;
    for (const ProblemBody &b : problem.bodies) {
        motion.push_back(scale_up(b, found ? b.found : b.free));
    }
    return motion;
}

Impulses found_impulses(const Problem &problem) {
    Impulses impulses;
    for (const ProblemContact &c : problem.contacts) {
        impulses.push_back(c.found);
    }
    return impulses;
}

Motion unscaled(const Problem &problem, const Motion &motion) {
    Motion velocities = motion;
    for (std::size_t i = 0; i < motion.size(); ++i) {
        const ProblemBody &body = problem.bodies[i];
        velocities[i].head<3>() *= std::sqrt(body.inverse_mass);
        velocities[i].tail<3>() = symmetric_root(body.inverse_inertia) * motion[i].tail<3>();
        if (body.inverse_mass <= 0) {
            velocities[i] = body.free;
        }
    }
    return velocities;
}

Motion System::motion(const Impulses &impulses) const {
    Motion w = free;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        push(i, impulses[i], w);
    }
    return w;
}

double distance(const Motion &a, const Motion &b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += (a[i] - b[i]).squaredNorm();
    }
    return std::sqrt(sum);
}

double residual(const System &system, const Impulses &impulses, const Motion &motion) {
    double sum = 0;
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
        const Row &row = system.rows[i];
        Vec3 speed = system.speed(i, motion);
        speed[0] += row.softness * impulses[i][0];
        // De Saxcé's speed: with it Coulomb's law is a complementarity of cones.
        speed[0] += row.friction * speed.tail<2>().norm();
        const double rho = 3 / row.delassus.trace();
        const Vec3 wrong = impulses[i] - onto_cone(impulses[i] - rho * speed, row.friction);
        sum += wrong.dot(row.delassus * wrong);
    }
    // Where contacts change next to nothing there is nothing to compare with but
    // the motion itself.
    const double all = distance(system.free, Motion(motion.size(), Vec6::Zero()));
    const double scale = std::max(distance(motion, system.free), NEGLIGIBLE * all);
    return scale > 0 ? std::sqrt(sum) / scale : (sum > 0 ? INFINITY : 0);
}

std::vector<double> body_errors(const System &system, const Motion &reference,
                                const Motion &found) {
    std::vector<char> touched(system.free.size(), 0);
    for (const Row &row : system.rows) {
        for (const int body : {row.a, row.b}) {
            if (body >= 0) {
                touched[static_cast<std::size_t>(body)] = 1;
            }
        }
    }
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < touched.size(); ++i) {
        if (touched[i]) {
            sum += (reference[i] - system.free[i]).squaredNorm();
            ++count;
        }
    }
    std::vector<double> errors;
    for (std::size_t i = 0; i < touched.size(); ++i) {
        if (touched[i]) {
            errors.push_back((reference[i] - found[i]).norm() / std::sqrt(sum / count));
        }
    }
    return errors;
}

} // namespace referee
