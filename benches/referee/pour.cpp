// Steps grains through time: finds their contacts, solves them, and moves the grains.
#include "pour.h"

#include <algorithm>
#include <cmath>
#include <set>

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

// An overlap at the end of a step, beyond what the pair's contact points say, that
// calls for another solution, in m.
constexpr double UNFORESEEN = 5e-6;

// A point of a grain where it was before the grain moved.
Vec3 carried_back(const Vec3 &point, const Grain &now, const Grain &before) {
    return before.position + before.rotation * (now.rotation.inverse() * (point - now.position));
}

} // namespace

Solution forces_only(const Step &, const Solution &first, const Limits &) { return first; }

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
    touches_.clear();
    for (const SceneTouch &t : scene_touches(scene_, margins)) {
        add(step, t, t.touch.point, t.touch.gap);
    }
    step.system = scaled(problem_);
    step.before = scaled_motion(problem_, true);
    return step;
}

// `point` and `gap` are those of the beginning.
void Pour::add(Step &step, const SceneTouch &t, const Vec3 &point, double gap) {
    ProblemContact c;
    c.a = t.a + 1;
    c.b = std::max(t.b, -1) + 1;
    const Vec3 arm_a = point - scene_.grains[static_cast<std::size_t>(t.a)].position;
    Vec3 arm_b = Vec3::Zero();
    if (t.b >= 0) {
        arm_b = point - scene_.grains[static_cast<std::size_t>(t.b)].position;
    }
    c.set_geometry(t.touch.normal, arm_a, arm_b);
    c.friction = friction_of(scene_, t);
    set_law(c, gap);
    problem_.contacts.push_back(c);
    touches_.push_back(t);
    step.gaps.push_back(gap);
    const auto known = memory_.find({t.a, t.b, t.touch.key});
    const Vec3 world = known == memory_.end() ? Vec3::Zero() : known->second;
    step.warm.emplace_back(c.axes * world);
}

// Contact points of the beginning do not foresee every overlap of the end: a corner
// beside the one that touched comes in, edges pass on to the next ones, an impact throws a
// grain further than its speed let expect. The grains are where `solution` moves them,
// and were at `before`. Overlaps that no contact point tells of become contact
// points, with the gaps that they had at the beginning.
std::vector<Pour::Unforeseen> Pour::unforeseen(const Step &step, const Solution &solution,
                                               const std::vector<Grain> &before) const {
    // The lowest gap at the end of each pair's contact points, and their features.
    std::map<std::pair<int, int>, double> foreseen;
    std::set<std::tuple<int, int, std::uint64_t>> known;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const SceneTouch &t = touches_[i];
        const double speed =
            step.system.speed(i, solution.motion)[0] - step.system.rows[i].fixed[0];
        double &lowest = foreseen.try_emplace({t.a, t.b}, 0).first->second;
        lowest = std::min(lowest, step.gaps[i] + step.length * speed);
        known.insert({t.a, t.b, t.touch.key});
    }
    std::vector<Unforeseen> found;
    const std::vector<double> margins(scene_.grains.size(), -UNFORESEEN / 2);
    for (const SceneTouch &t : scene_touches(scene_, margins)) {
        const auto pair = foreseen.find({t.a, t.b});
        const double more = (pair == foreseen.end() ? 0 : pair->second) - t.touch.gap;
        if (more <= UNFORESEEN || known.count({t.a, t.b, t.touch.key}) > 0) {
            continue;
        }
        const auto a = static_cast<std::size_t>(t.a), b = static_cast<std::size_t>(t.b);
        const Vec3 half = 0.5 * t.touch.gap * t.touch.normal;
        const Vec3 at_a = carried_back(t.touch.point + half, scene_.grains[a], before[a]);
        Vec3 at_b = t.touch.point - half;
        if (t.b >= 0) {
            at_b = carried_back(at_b, scene_.grains[b], before[b]);
        }
        found.push_back({t, 0.5 * (at_a + at_b), t.touch.normal.dot(at_a - at_b), more});
    }
    return found;
}

// Solves the step and moves the grains by it.
Solution Pour::moved_by_forces(Step &step) {
    const std::vector<Grain> before = scene_.grains;
    Solution all;
    for (int look = 1;; ++look) {
        Solution solution = solve(step.system, step.warm, settings_.limits);
        move(solution.motion);
        ++record_.looks;
        solution.iterations += all.iterations;
        solution.newton_steps += all.newton_steps;
        all = solution;
        const std::vector<Unforeseen> found = unforeseen(step, solution, before);
        if (found.empty() || look >= settings_.most_looks) {
            for (const Unforeseen &u : found) {
                record_.unforeseen = std::max(record_.unforeseen, u.overlap);
            }
            return all;
        }
        scene_.grains = before;
        step.warm = solution.impulses;
        for (const Unforeseen &u : found) {
            add(step, u.touch, u.point, u.gap);
        }
        step.system = scaled(problem_);
    }
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

void Pour::move(const Motion &scaled_velocities) {
    const double h = settings_.step;
    const Motion velocities = unscaled(problem_, scaled_velocities);
    for (std::size_t i = 0; i < scene_.grains.size(); ++i) {
        Grain &grain = scene_.grains[i];
        const Vec6 &velocity = velocities[i + 1];
        grain.position += h * velocity.head<3>();
        grain.rotation = (rotation_by(h * velocity.tail<3>()) * grain.rotation).normalized();
    }
}

void Pour::step() {
    Step step = pose_step();
    const std::vector<Grain> before = scene_.grains;
    const Solution first = moved_by_forces(step);
    const Solution solution = law_(step, first, settings_.limits);
    const Motion velocities = unscaled(problem_, solution.motion);
    memory_.clear();
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        ProblemContact &c = problem_.contacts[i];
        c.found = solution.impulses[i];
        if (first.impulses[i][0] > 0) {
            memory_[{touches_[i].a, touches_[i].b, touches_[i].touch.key}] =
                c.axes.transpose() * first.impulses[i];
        }
    }
    for (std::size_t i = 0; i < velocities.size(); ++i) {
        problem_.bodies[i].found = velocities[i];
    }
    for (std::size_t i = 0; i < before.size(); ++i) {
        Grain &grain = scene_.grains[i];
        const Vec6 &velocity = velocities[i + 1];
        grain.velocity = velocity.head<3>();
        // The rotation goes on with the same angular momentum.
        grain.spin = inertia(grain, true) * (inertia(before[i], false) * velocity.tail<3>());
    }
    ++record_.steps;
    record_.simulated += settings_.step;
    record_.iterations += solution.iterations;
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
    record_.iterations /= record_.steps;
    record_.newton_steps /= record_.steps;
    record_.looks /= record_.steps;
    record_.unsolved /= record_.steps;
    record_.energy_gain /= std::max(start - before, 1e-300);
    return record_;
}

} // namespace referee
