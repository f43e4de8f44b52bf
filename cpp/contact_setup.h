// Pluvia's own contacts as a world's definition asks for them.
#pragma once

#include "contact_solver.h"
#include "convert.h"
#include "hull_algorithm.h"
#include "settings.h"

#include <memory>

namespace pluvia {

std::unique_ptr<HullCollision> make_hull_collision(const Units &units, const WorldDefinition &d);

std::unique_ptr<ContactSolver> make_contact_solver(const Units &units, const WorldDefinition &d,
                                                   const HullCollision &collision,
                                                   Workers &workers);

// The law as the solver holds it.
void read_solver(const Units &units, const ContactSolver &solver, ReadBack &into);

} // namespace pluvia
