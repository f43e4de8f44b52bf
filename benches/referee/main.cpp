// The referee: solves contact problems exactly, and pours grains by itself.
//
//   referee check          its own checks
//   referee steps [twice]  problems (problem.h) on standard input, one a line; twice:
//                          solved from what was found, and from nothing
//   referee pour STEP_S DURATION_S TOLERANCE
//   referee measure        scenes (scene.h) on standard input, one a line
//   referee contacts GAP_M DOUBT_M
//
// Answers are JSON on standard output, one a line for each line that was read.
#include "checks.h"
#include "pour.h"
#include "restitution.h"
#include "siconos.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <iostream>

namespace referee {
namespace {

using nlohmann::json;

// Gap up to which grains count as touching when they are counted, m.
constexpr double TOUCHING_GAP = 5e-5;

json list(const Vec3 &v) { return {v.x(), v.y(), v.z()}; }

int check() {
    Checks checks(std::cout);
    check_contacts(checks);
    check_problems(checks);
    check_stepping(checks);
    std::cout << checks.made() - checks.failed() << " of " << checks.made()
              << " checks of the referee hold\n";
    return checks.failed() == 0 ? 0 : 1;
}

// Percentile by nearest rank.
double percentile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(1.0, rank)) - 1];
}

json step(const std::string &line, bool twice) {
    const Problem problem = read_problem(line);
    const System system = scaled(problem);
    const Limits limits{1e-10, 1000, 1000};
    const Impulses given = found_impulses(problem);
    using Clock = std::chrono::steady_clock;
    const auto begun = Clock::now();
    const Impulses nothing(given.size(), Vec3::Zero());
    Solution near = solve(system, given, limits);
    if (near.residual > limits.tolerance) {
        const Solution other = solve(system, nothing, limits);
        near = other.residual < near.residual ? other : near;
    }
    const std::chrono::duration<double> wall = Clock::now() - begun;
    const Motion found = scaled_motion(problem, true);
    const auto errors = body_errors(system, near.motion, found);
    const Motion pushed = system.motion(given);
    json out = {{"scene", problem.scene},
                {"engine", problem.engine},
                {"time_s", problem.time},
                {"bodies", errors.size()},
                {"contacts", system.rows.size()},
                {"velocity_errors", errors},
                {"velocity_error_median", percentile(errors, 0.5)},
                {"velocity_error_p99", percentile(errors, 0.99)},
                {"velocity_error_worst", percentile(errors, 1)},
                {"residual", near.residual},
                {"residual_given", residual(system, given, pushed)},
                {"siconos_error", siconos_error(system, near.impulses)},
                // Velocities and impulses that were given must belong together.
                {"inconsistency", distance(pushed, found) / distance(found, system.free)},
                {"iterations", near.iterations},
                {"newton_steps", near.newton_steps},
                {"wall_s", wall.count()}};
    if (twice) {
        // From nothing: another solution, where there is more than one.
        const Solution afresh = solve(system, nothing, limits);
        const auto other = body_errors(system, near.motion, afresh.motion);
        out.update({{"afresh_p99", percentile(other, 0.99)},
                    {"afresh_worst", percentile(other, 1)},
                    {"residual_afresh", afresh.residual}});
    }
    return out;
}

json measured(const Scene &scene) {
    const Packing packing = measure(scene, TOUCHING_GAP);
    return {{"mean_height_m", packing.mean_height},
            {"coordination", packing.coordination},
            {"deepest_overlap_m", packing.deepest_overlap},
            {"outside", packing.outside}};
}

json pour(const std::string &line, const PourSettings &settings) {
    const Scene scene = read_scene(line);
    const ImpactRule rule{scene.restitution, scene.restitution_threshold, scene.closed_gap,
                          scene.met_gap};
    Pour pour(scene, settings, compression_and_restitution(rule));
    const PourRecord record = pour.run();
    json out = measured(pour.scene());
    out.update({{"simulated_s", record.simulated},
                {"steps", record.steps},
                {"iterations", record.iterations},
                {"newton_steps", record.newton_steps},
                {"worst_residual", record.worst_residual},
                {"unsolved", record.unsolved},
                {"looks", record.looks},
                {"unforeseen_m", record.unforeseen},
                {"energy_gain", record.energy_gain},
                {"sliding", record.sliding},
                {"at_rest", record.at_rest},
                {"grains", json::array()}});
    for (const Grain &grain : pour.scene().grains) {
        const Quat &q = grain.rotation;
        out["grains"].push_back({{"position_m", list(grain.position)},
                                 {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}});
    }
    return out;
}

json contacts(const std::string &line, double gap, double doubt) {
    const Scene scene = read_scene(line);
    json out = {{"weights_n", json::array()},
                {"centres_m", json::array()},
                {"radii_m", json::array()},
                {"contacts", json::array()}};
    for (const Grain &grain : scene.grains) {
        out["weights_n"].push_back(list(grain.mass * scene.gravity));
        out["centres_m"].push_back(list(grain.position));
        out["radii_m"].push_back(grain.hull.radius);
    }
    const std::vector<double> margins(scene.grains.size(), gap);
    for (const SceneTouch &t : scene_touches(scene, margins, doubt)) {
        if (t.touch.gap <= gap) {
            out["contacts"].push_back({{"a", t.a},
                                       {"b", t.b},
                                       {"point_m", list(t.touch.point)},
                                       {"normal", list(t.touch.normal)},
                                       {"gap_m", t.touch.gap},
                                       {"friction", friction_of(scene, t)}});
        }
    }
    return out;
}

int answer(const std::function<json(const std::string &)> &question) {
    std::ios::sync_with_stdio(false);
    for (std::string line; std::getline(std::cin, line);) {
        std::cout << question(line) << std::endl;
    }
    return 0;
}

int run(const std::vector<std::string> &args) {
    const std::string command = args.empty() ? "" : args[0];
    const auto number = [&](std::size_t i) { return std::stod(args.at(i)); };
    if (command == "check") {
        return check();
    }
    if (command == "steps") {
        const bool twice = args.size() > 1 && args[1] == "twice";
        return answer([twice](const std::string &line) { return step(line, twice); });
    }
    if (command == "measure") {
        return answer([](const std::string &line) { return measured(read_scene(line)); });
    }
    if (command == "contacts") {
        const double gap = number(1), doubt = number(2);
        return answer([=](const std::string &line) { return contacts(line, gap, doubt); });
    }
    if (command == "pour") {
        PourSettings settings;
        settings.step = number(1);
        settings.duration = number(2);
        settings.limits.tolerance = number(3);
        return answer([&](const std::string &line) { return pour(line, settings); });
    }
    std::cerr
        << "usage: referee check | steps [twice] | pour STEP_S DURATION_S TOLERANCE | measure | "
           "contacts GAP_M DOUBT_M\n";
    return 2;
}

} // namespace
} // namespace referee

int main(int argc, char **argv) {
    try {
        return referee::run({argv + 1, argv + argc});
    } catch (const std::exception &error) {
        std::cerr << "error: " << error.what() << '\n';
        return 1;
    }
}
