// How well a sub-step was solved, and the problem itself for others to solve.
#pragma once

#include <vector>

namespace pluvia {

// Sums over contacts, in the kinetic norm: impulses squared by the mass that
// the contact shows, so that both are energies.
struct Residual {
    double error = 0, impulse = 0;
};

// The problem of a sub-step as the solver had it, and what it found; engine
// units. Bodies turn in it by the root of their inertia times their spin, so
// that the mass matrix is the mass three times and 1 three times.
struct SubstepRecord {
    // Of each: inverse mass; velocity and spin with all but the contacts'
    // impulses; velocity and spin found.
    static constexpr int BODY = 13;
    // Of each: bodies a and b; of normal and two tangents the direction and the
    // moment that a unit impulse has on a and on b; friction, bias velocity, softness;
    // approach velocity, restitution; the impulses found.
    static constexpr int CONTACT = 2 + 3 * 9 + 3 + 2 + 3;
    std::vector<double> bodies, contacts;
};

// What is looked at in the last sub-step of a step; the problem where `record` is given.
struct Look {
    Residual residual;
    SubstepRecord *record = nullptr;
};

} // namespace pluvia
