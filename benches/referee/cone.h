// Coulomb's law at one contact point.
#pragma once

#include "algebra.h"

namespace referee {

// The impulse that solves one contact by itself, exactly: speed = w·λ + q, with
// the complementarity and Coulomb's law of problem.h. `w` must be positive
// definite. `alpha` is where sliding begins to be sought, 0 at first, and keeps
// where it was found.
Vec3 solve_contact(const Mat3 &w, const Mat3 &inverse, const Vec3 &q, double friction,
                   double &alpha);

// The same with a normal impulse that is given: Coulomb's law alone.
Vec3 solve_loaded_contact(const Mat3 &w, const Vec3 &q, double friction, double normal);

// The nearest point of the friction cone.
Vec3 onto_cone(const Vec3 &impulse, double friction);

// Alart and Curnier's map with a step ρ: a fixed point of it, λ = map(λ, u),
// obeys the law, and nothing else does. Softness is part of the speed.
Vec3 natural_map(const Vec3 &impulse, const Vec3 &speed, double friction, double rho);

} // namespace referee
