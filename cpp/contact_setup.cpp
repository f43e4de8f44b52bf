#include "contact_setup.h"

#include "pluvia/src/world/bullet/ffi.rs.h"

#include <algorithm>

namespace pluvia {

HullCollision hull_collision(const Units &units, const WorldDefinition &d,
                             const Materials &materials) {
    HullCollision collision;
    collision.materials = &materials;
    collision.settings = pair_settings(d.tolerances, units.scale());
    collision.settings.speculative_margin =
        std::min(d.contact_threshold, d.tolerances.contact_margin) * units.scale();
    collision.match = d.tolerances.match_distance * units.scale();
    collision.kernels = d.portable ? &portable_axis_kernels() : &axis_kernels();
    collision.step = d.time_step;
    return collision;
}

ContactLaw contact_law(const Units &units, const WorldDefinition &d) {
    const double scale = units.scale();
    return {d.substeps,
            d.native_iterations,
            d.contact_stiffness,
            d.contact_damping_ratio,
            d.max_depenetration_velocity * scale,
            d.restitution_velocity_threshold * scale,
            d.tolerances.closed_gap * scale,
            d.tolerances.unsolved_gap * scale,
            d.solver_tolerance};
}

Kernels kernels(const WorldDefinition &d) {
    return d.contacts_at_once == 1     ? Kernels::OneByOne
           : has_avx2() && !d.portable ? Kernels::Avx2
                                       : Kernels::Portable;
}

void read_solver(const Units &units, const ContactSolver &solver, ReadBack &into) {
    const ContactLaw &law = solver.law();
    into.put("portable_instructions", solver.kernels() == Kernels::Portable);
    into.put("substeps", law.substeps);
    into.put("iterations_in_a_substep", law.iterations);
    into.put("solver_tolerance", law.unsolved_share);
    into.put("contact_stiffness_n_per_m", law.stiffness);
    into.put("contact_damping_ratio", law.damping_ratio);
    into.put("max_depenetration_velocity_m_per_s", law.max_depenetration_velocity / units.scale());
    into.put("restitution_speed_m_per_s", law.restitution_speed / units.scale());
    into.put("closed_gap_m", law.closed_gap / units.scale());
    into.put("unsolved_gap_m", law.unsolved_gap / units.scale());
    into.put("contacts_at_once", solver.kernels() == Kernels::OneByOne ? 1 : 8);
}

} // namespace pluvia
