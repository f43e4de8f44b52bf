#include "pour.h"

#include <algorithm>
#include <cmath>

namespace referee {

namespace {

Mat3 inertia(const Grain &grain, bool inverse) {
    const Mat3 turn = grain.rotation.toRotationMatrix();
    const Vec3 moments = inverse ? Vec3(grain.inertia.cwiseInverse()) : grain.inertia;
    return turn * moments.asDiagonal() * turn.transpose();
}

Quat rotation_by(const Vec3 &turn) {
    const double angle = turn.norm();
    return angle > 0 ? Quat(Eigen::AngleAxisd(angle, turn / angle)) : Quat::Identity();
}

} // namespace

Solution inelastic(const Step &step, const Limits &limits) {
    return solve(step.system, step.warm, limits);
}

Pour::Pour(Scene scene, const PourSettings &settings, Law law)
    : scene_(std::move(scene)), settings_(settings), law_(std::move(law)) {}

// Body 0 is the walls, grain i is body i + 1.
Step Pour::pose_step() {
    const double h = settings_.step;
    problem_ = {"pour", "referee", record_.simulated, h, {ProblemBody{}}, {}};
    std::vector<double> margins;
    for (const Grain &grain : scene_.grains) {
        ProblemBody body;
        body.inverse_mass = 1 / grain.mass;
        body.inverse_inertia = inertia(grain, true);
        body.free << grain.velocity + h * scene_.gravity, grain.spin;
        body.found << grain.velocity, grain.spin;
        problem_.bodies.push_back(body);
        const double speed = body.free.head<3>().norm() + grain.spin.norm() * grain.hull.radius;
        margins.push_back(1.2 * h * speed + 2e-5);
    }
    Step step;
    step.length = h;
    touches_ = scene_touches(scene_, margins);
    for (const SceneTouch &t : touches_) {
        ProblemContact c;
        c.a = t.a + 1;
        c.b = std::max(t.b, -1) + 1;
        const Vec3 arm_a = t.touch.point - scene_.grains[static_cast<std::size_t>(t.a)].position;
        Vec3 arm_b = Vec3::Zero();
        if (t.b >= 0) {
            arm_b = t.touch.point - scene_.grains[static_cast<std::size_t>(t.b)].position;
        }
        c.set_geometry(t.touch.normal, arm_a, arm_b);
        c.friction = friction_of(scene_, t);
        set_law(c, t.touch.gap);
        problem_.contacts.push_back(c);
        step.gaps.push_back(t.touch.gap);
        const auto known = memory_.find({t.a, t.b, t.touch.key});
        const Vec3 world = known == memory_.end() ? Vec3::Zero() : known->second;
        step.warm.emplace_back(c.axes * world);
    }
    step.system = scaled(problem_);
    step.before = scaled_motion(problem_, true);
    return step;
}

// A spring k and a damper c, implicit over a step h: u_n + γ λ_n ≥ −gap k/(c + h k)
// with γ = 1/(h (c + h k)). A gap that is open closes by its size at most.
void Pour::set_law(ProblemContact &c, double gap) const {
    const double h = settings_.step;
    double inverse_mass = 0;
    for (const auto &[number, moments] :
         {std::pair(c.a, &c.moments_a), std::pair(c.b, &c.moments_b)}) {
        const ProblemBody &body = problem_.bodies[static_cast<std::size_t>(number)];
        const Vec3 moment = moments->row(0);
        inverse_mass += body.inverse_mass + moment.dot(body.inverse_inertia * moment);
    }
    const double damping =
        2 * settings_.damping_ratio * std::sqrt(settings_.stiffness / inverse_mass);
    const double firm = damping + h * settings_.stiffness;
    c.softness = 1 / (h * firm);
    c.target = gap > 0 ? -gap / h
                       : std::min(-gap * settings_.stiffness / firm, settings_.depenetration_speed);
}

void Pour::move() {
    const double h = settings_.step;
    for (std::size_t i = 0; i < scene_.grains.size(); ++i) {
        Grain &grain = scene_.grains[i];
        const Vec6 &velocity = problem_.bodies[i + 1].found;
        grain.velocity = velocity.head<3>();
        grain.position += h * grain.velocity;
        // The rotation goes on with the same angular momentum.
        const Vec3 momentum = inertia(grain, false) * velocity.tail<3>();
        grain.rotation = (rotation_by(h * velocity.tail<3>()) * grain.rotation).normalized();
        grain.spin = inertia(grain, true) * momentum;
    }
}

void Pour::step() {
    const Step step = pose_step();
    Solution solution = law_(step, settings_.limits);
    const Motion velocities = unscaled(problem_, solution.motion);
    memory_.clear();
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        ProblemContact &c = problem_.contacts[i];
        c.found = solution.impulses[i];
        if (c.found[0] > 0) {
            memory_[{touches_[i].a, touches_[i].b, touches_[i].touch.key}] =
                c.axes.transpose() * c.found;
        }
    }
    for (std::size_t i = 0; i < velocities.size(); ++i) {
        problem_.bodies[i].found = velocities[i];
    }
    move();
    ++record_.steps;
    record_.simulated += settings_.step;
    record_.sweeps += solution.sweeps;
    record_.newton_steps += solution.newton_steps;
    record_.unsolved += solution.residual > settings_.limits.tolerance;
    record_.worst_residual = std::max(record_.worst_residual, solution.residual);
}

double Pour::energy() const {
    double sum = 0;
    for (const Grain &g : scene_.grains) {
        sum += 0.5 * g.mass * g.velocity.squaredNorm() +
               0.5 * g.spin.dot(inertia(g, false) * g.spin) -
               g.mass * scene_.gravity.dot(g.position);
    }
    return sum;
}

double Pour::fastest() const {
    double most = 0;
    for (const Grain &g : scene_.grains) {
        most = std::max(most, g.velocity.norm() + g.spin.norm() * g.hull.radius);
    }
    return most;
}

PourRecord Pour::run() {
    record_ = {};
    const double start = energy();
    double slow = 0, before = start;
    const auto mean_height = [&] {
        double sum = 0;
        for (const Grain &g : scene_.grains) {
            sum += g.position.z();
        }
        return sum / static_cast<double>(scene_.grains.size());
    };
    const auto steps = static_cast<int>(std::lround(settings_.duration / settings_.step));
    for (int n = 1; n <= steps && !record_.at_rest; ++n) {
        step();
        const double now = energy();
        record_.energy_gain = std::max(record_.energy_gain, now - before);
        before = now;
        slow = fastest() < settings_.rest_speed ? slow + settings_.step : 0;
        record_.at_rest = slow >= settings_.rest_time;
        if (n % std::max(1, steps / 50) == 0 || n == steps || record_.at_rest) {
            record_.heights.emplace_back(record_.simulated, mean_height());
        }
    }
    double loaded = 0, sliding = 0;
    for (const ProblemContact &c : problem_.contacts) {
        if (c.found[0] > 0) {
            ++loaded;
            sliding += std::hypot(c.found[1], c.found[2]) > 0.999 * c.friction * c.found[0];
        }
    }
    record_.sliding = loaded > 0 ? sliding / loaded : 0;
    record_.sweeps /= record_.steps;
    record_.newton_steps /= record_.steps;
    record_.unsolved /= record_.steps;
    record_.energy_gain /= std::max(start - before, 1e-300);
    return record_;
}

} // namespace referee
