// Pluvia's contact solver.
#pragma once

#include "contact_bodies.h"
#include "contact_load.h"
#include "convert.h"
#include "rust/cxx.h"
#include "workers.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <memory>
#include <unordered_map>
#include <vector>

namespace pluvia {

struct DriveRead;
struct WorldDefinition;
template <class L> class Run;

// Solves all contacts of a step at once: projected Gauss–Seidel in sub-steps that
// begins with the last step's impulses less its impacts, friction within its cone,
// normals as implicit springs, restitution as set. One pair at a time in double precision, or eight
// in single precision: then with the same bits with and without AVX2, on any number of threads.
class ContactSolver {
  public:
    // `touching`: the contacts of the step at hand, in the place of Bullet's manifolds.
    ContactSolver(const std::vector<Touching> &touching, const Units &units,
                  const WorldDefinition &definition, Workers &workers);
    ~ContactSolver();

    // To be called at the beginning of a step with all bodies of the world.
    void sort_bodies(const btCollisionObjectArray &bodies);
    // The kinematic ones that are not pressed.
    const std::vector<btRigidBody *> &kinematic() const { return kinematic_; }
    // The speeds that bodies gain in a step, given `gravity`. To be called once a step; `goes_on`:
    // in the first of a world whether contacts of another bear what they bore there.
    void take_gains(double gravity, double step, double margin, bool goes_on, Gains &gains);
    // Gives the parts of these their velocities.
    void carry_parts();

    // To be called once a step.
    void solve(double step);

    // Moves the bodies by what was found.
    void move_bodies(double step);

    // To be called when a body came.
    void bodies_changed();
    // To be called when a body went.
    void forget(int number) {
        drives_.erase(number);
        presses_.erase(number);
        wholes_.erase(number);
        bodies_changed();
    }

    // A kinematic body that moves along one direction alone from now on, by its number.
    void press(int number, const Press &press) {
        presses_[number] = press;
        bodies_changed();
    }
    // Sets the force on it in N, or of what turns the moment in N m.
    void set_force(int number, double force) {
        Press &press = presses_.at(number);
        press.force = force * press.unit;
    }

    // A body that is a further part of another one from now on, which is none itself: they are one
    // body of the solver, whose centre of mass is the origin of both. By their numbers.
    void join(int number, int whole) {
        wholes_[number] = whole;
        bodies_changed();
    }
    // Whether others are parts of a body.
    bool has_parts(int number) const {
        return std::any_of(wholes_.begin(), wholes_.end(),
                           [number](const auto &part) { return part.second == number; });
    }
    // The number of the body that a body is a part of: its own, if it is none.
    int whole_of(int number) const {
        const auto found = wholes_.find(number);
        return found == wholes_.end() ? number : found->second;
    }

    // How a kinematic body moved before the first step of its world, by its number.
    void recall_drive(int number, const Drive &drive) { drives_[number] = drive; }
    // Adds how each kinematic body went through the last step; none once a body came or went.
    void read_drives(const Units &units, rust::Vec<DriveRead> &out) const;

    // By number the thread that had most to do with a body in the last step; for one that does
    // not move, more than any.
    const std::vector<std::uint16_t> &homes() const { return body_homes_; }

    const ContactLaw &law() const { return law_; }
    bool gyroscopic() const { return gyroscopic_; }
    // Natural-map residual of the last sub-step of the step inspected last, over
    // its impulses, both in the kinetic norm; negative before the first.
    double residual() const { return residual_; }
    // Has the last sub-step of every step recorded from now on.
    void record() { recording_ = true; }
    const SubstepRecord &recorded() const { return recorded_; }
    bool one_by_one() const { return one_by_one_; }

  private:
    const std::vector<Touching> &touching_;
    ContactLaw law_;
    bool one_by_one_, gyroscopic_;
    Kernel<Float8> kernel_; // of eight at a time
    Workers &workers_;
    struct Moving {
        btRigidBody *body;
        int number; // in the world
    };
    std::vector<Moving> moving_;           // every free body
    std::vector<btRigidBody *> pressed_;   // every body that is pressed
    std::vector<btRigidBody *> kinematic_; // every other kinematic body
    struct Part {
        btRigidBody *own, *whole;
    };
    std::vector<Part> parts_;  // every further part of a body
    std::vector<Vec> centres_; // of mass, of the free bodies
    std::vector<int> place_;   // by the body's number: among bodies_
    // The world, free bodies along the specimen, those that are pressed, kinematic ones.
    std::vector<SolverBody> bodies_;
    std::vector<PairPlace> places_; // of the pairs that touch
    Colours colours_;
    Homes homes_;
    std::vector<std::uint16_t> body_homes_; // by the body's number
    std::unique_ptr<Run<double>> single_;
    std::unique_ptr<Run<Float8>> eight_;
    bool sorted_ = false; // the lists of bodies are those of the world
    // By the body's number in its world: a new body may get the address of one that left.
    std::unordered_map<int, Drive> drives_;
    std::unordered_map<int, Press> presses_; // by the same number
    std::unordered_map<int, int> wholes_;    // of further parts, by the same number
    bool recording_ = false;
    unsigned steps_ = 0;
    double residual_ = -1;
    SubstepRecord recorded_;

    void sort_places();
    void take_bodies(double step);
    void take_pairs(double step);
};

} // namespace pluvia
