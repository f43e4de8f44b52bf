#include "phased_world.h"

#include <chrono>

namespace pluvia {

namespace {

// Adds the time from its making to its end to a sum, and takes it from another.
class Stopwatch {
  public:
    Stopwatch(double &sum, double &of)
        : sum_(sum), of_(of), begin_(std::chrono::steady_clock::now()) {}
    ~Stopwatch() {
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
        sum_ += spent.count();
        of_ -= spent.count();
    }
    Stopwatch(const Stopwatch &) = delete;
    Stopwatch &operator=(const Stopwatch &) = delete;

  private:
    double &sum_;
    double &of_;
    std::chrono::steady_clock::time_point begin_;
};

} // namespace

int PhasedWorld::stepSimulation(btScalar step, int most_substeps, btScalar fixed_step) {
    double outside = 0;
    const Stopwatch watch(phases_.integration, outside);
    return btDiscreteDynamicsWorld::stepSimulation(step, most_substeps, fixed_step);
}

void PhasedWorld::performDiscreteCollisionDetection() {
    const Stopwatch watch(phases_.collision, phases_.integration);
    btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
}

void PhasedWorld::updateAabbs() {
    const Stopwatch watch(phases_.broadphase, phases_.collision);
    renew_boxes();
}

void PhasedWorld::computeOverlappingPairs() {
    const Stopwatch watch(phases_.broadphase, phases_.collision);
    btDiscreteDynamicsWorld::computeOverlappingPairs();
}

void PhasedWorld::solveConstraints(btContactSolverInfo &info) {
    const Stopwatch watch(phases_.solver, phases_.integration);
    solve(info);
}

} // namespace pluvia
