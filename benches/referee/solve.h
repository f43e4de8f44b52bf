// Solvers for the problem of problem.h. Who found a solution does not matter:
// its residual says whether it is one.
#pragma once

#include "problem.h"

namespace referee {

struct Limits {
    double tolerance = 1e-10; // of the residual
    int iterations = 2000;    // of the nonsmooth Gauss–Seidel method before Newton's
    int newton_steps = 400;   // linear systems at most; 0: iterations alone
};

struct Solution {
    Impulses impulses;
    Motion motion;
    double residual = 0;
    int iterations = 0, newton_steps = 0;
};

// Iterations of exact solutions contact by contact; if they do not get there,
// Newton's method on the velocities (newton.h), in turns with more iterations.
Solution solve(const System &system, const Impulses &start, const Limits &limits);

} // namespace referee
