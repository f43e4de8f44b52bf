// The referee's own time stepping (Moreau–Jean, implicit in the impulses).
#pragma once

#include "scene.h"
#include "solve.h"

#include <functional>
#include <map>

namespace referee {

struct PourSettings {
    double step = 5e-4;
    double duration = 1;
    // Residual to which each step is solved, and the work it may take.
    Limits limits{1e-4, 300, 10};
    // Softness of contact points, as implicit springs with dampers: stiffness in N/m,
    // damping ratio with the bodies they stand between. Rigid points would leave
    // the impulses of a face's four corners open, and the solver to grope for them.
    double stiffness = 1e4, damping_ratio = 1;
    double depenetration_speed = 0.05; // fastest that an overlap is pushed apart, m/s
    // Solutions of a step until no overlap is left at its end that its contact points do
    // not know of, at most.
    int most_looks = 12;
    // A packing whose fastest grain stays slower, in m/s, for so long is at rest.
    double rest_speed = 1e-4, rest_time = 0.05;
};

struct PourRecord {
    double simulated = 0;
    int steps = 0;
    double iterations = 0, newton_steps = 0; // mean per step
    double worst_residual = 0;
    double unsolved = 0;    // share of steps whose residual stays above the tolerance
    double looks = 0;       // mean solutions of a step until no overlap was left that
                            // its contact points do not know of
    double unforeseen = 0;  // largest such overlap that was left all the same, m
    double energy_gain = 0; // largest of a step, over the energy that the fall set free
    double sliding = 0;     // share of the loaded contact points that slide at the end
    bool at_rest = false;
    std::vector<std::pair<double, double>> heights; // time, mean height
};

// A step as the law of impact sees it. `system` asks that gaps close by their
// size at most.
struct Step {
    System system;
    Motion before; // scaled velocities when the step begins, without gravity's share
    Impulses warm;
    std::vector<double> gaps;
    double length;
};

// Velocities at the end of a step, and all impulses in it. The solution that is given
// is that of `system`; it has moved the bodies.
using Law = std::function<Solution(const Step &, const Solution &, const Limits &)>;

// Forces alone: impacts are not told from them.
Solution forces_only(const Step &step, const Solution &first, const Limits &limits);

class Pour {
  public:
    Pour(Scene scene, const PourSettings &settings, Law law);
    PourRecord run();
    void step();
    double energy() const;
    const Scene &scene() const { return scene_; }
    // The problem of the last step, with what was found.
    const Problem &last() const { return problem_; }

  private:
    Scene scene_;
    PourSettings settings_;
    Law law_;
    Problem problem_;
    PourRecord record_;
    Impulses impulses_;
    std::vector<SceneTouch> touches_;
    // Impulses of the last step by bodies and features, in world axes.
    std::map<std::tuple<int, int, std::uint64_t>, Vec3> memory_;

    Step pose_step();
    void add(Step &step, const SceneTouch &touch, const Vec3 &point, double gap);
    // A contact point that only the end of a step shows, with its place and gap at the
    // beginning, and what it overlaps at the end beyond what the others tell of.
    struct Unforeseen {
        SceneTouch touch;
        Vec3 point;
        double gap, overlap;
    };
    std::vector<Unforeseen> unforeseen(const Step &step, const Solution &solution,
                                       const std::vector<Grain> &before) const;
    Solution moved_by_forces(Step &step);
    void set_law(ProblemContact &contact, double gap) const;
    void move(const Motion &scaled_velocities);
    double fastest() const;
};

} // namespace referee
