#include "contact_setup.h"

#include "pluvia/src/world/bullet/ffi.rs.h"

#include <algorithm>

namespace pluvia {

namespace {

// Contact points are kept up to this gap at most: with whole manifolds every
// step, a point need not be foreseen long before it touches.
constexpr double LARGEST_REACH = 0.2e-3; // m

// A hundredth of a millimetre: contacts closer than that touch.
constexpr double CLOSED_GAP = 0.01e-3; // m

// A fiftieth of a millimetre.
constexpr double UNSOLVED_GAP = 0.02e-3; // m

} // namespace

std::unique_ptr<HullCollision> make_hull_collision(const Units &units, const WorldDefinition &d) {
    auto collision = std::make_unique<HullCollision>();
    const double reach = std::min(d.contact_threshold, LARGEST_REACH);
    collision->settings = pair_settings(reach * units.scale(), units.scale());
    collision->match = match_distance(units.scale());
    collision->kernels = d.portable ? &portable_axis_kernels() : &axis_kernels();
    collision->step = d.time_step;
    return collision;
}

std::unique_ptr<ContactSolver> make_contact_solver(const Units &units, const WorldDefinition &d,
                                                   const HullCollision &collision,
                                                   Workers &workers) {
    const double scale = units.scale();
    const ContactLaw law{d.substeps,
                         d.sweeps,
                         d.contact_stiffness,
                         d.contact_damping_ratio,
                         d.push_out_speed * scale,
                         d.restitution_velocity_threshold * scale,
                         CLOSED_GAP * scale,
                         UNSOLVED_GAP * scale,
                         d.solver_tolerance};
    const Sweep sweep = d.contacts_at_once == 1     ? Sweep::OneByOne
                        : has_avx2() && !d.portable ? Sweep::Avx2
                                                    : Sweep::Portable;
    return std::make_unique<ContactSolver>(collision.touching, law, sweep, d.gyroscopic, workers);
}

void read_solver(const Units &units, const ContactSolver &solver, ReadBack &into) {
    const ContactLaw &law = solver.law();
    into.put("portable_instructions", solver.sweep() == Sweep::Portable);
    into.put("substeps", law.substeps);
    into.put("sweeps_in_a_substep", law.sweeps);
    into.put("solver_tolerance", law.unsolved_share);
    into.put("contact_stiffness_n_per_m", law.stiffness);
    into.put("contact_damping_ratio", law.damping_ratio);
    into.put("push_out_speed_m_per_s", law.push_out_speed / units.scale());
    into.put("restitution_speed_m_per_s", law.restitution_speed / units.scale());
    into.put("closed_gap_m", law.closed_gap / units.scale());
    into.put("contacts_at_once", solver.sweep() == Sweep::OneByOne ? 1 : 8);
}

} // namespace pluvia
