// Newton's method on the velocities of the bodies.
#pragma once

#include "problem.h"

#include <memory>

namespace referee {

// Proximal steps with Alart and Curnier's map: about a centre λ⁰, impulses are
// functions of the velocities, λ(w) = map(λ⁰, u(w)) with a stiffness of each
// contact, and
//
//   F(w) = w − w_free − Jᵀ λ(w) = 0
//
// has as many unknowns as the bodies have, however many points carry them. Its
// solution is the next centre; where that is the same as the last, the problem
// is solved exactly, whatever the stiffness.
class Newton {
  public:
    explicit Newton(const System &system);
    ~Newton();
    // One proximal step with `stiffness` times that of a contact by itself, until
    // F is below `precision` of what contacts change. Moves the centre and the
    // motion; false if F could not be made so small. Takes the linear systems
    // that it solves off `steps`.
    bool step(double stiffness, double precision, Impulses &centre, Motion &motion, int &steps);

  private:
    struct Work;
    const System &system_;
    std::unique_ptr<Work> work_;
};

} // namespace referee
