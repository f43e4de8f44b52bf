// Pluvia's own contacts as a world's definition asks for them.
#pragma once

#include "bodies.h"
#include "contact_solver.h"
#include "convert.h"
#include "hull_algorithm.h"
#include "settings.h"

namespace pluvia {

HullCollision hull_collision(const Units &units, const WorldDefinition &d,
                             const Materials &materials);

ContactLaw contact_law(const Units &units, const WorldDefinition &d);

Kernels kernels(const WorldDefinition &d);

// The law as the solver holds it.
void read_solver(const Units &units, const ContactSolver &solver, ReadBack &into);

} // namespace pluvia
