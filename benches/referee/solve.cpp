// Solves a contact problem contact by contact, and goes on with Newton's method where that does not
// get there.
#include "solve.h"

#include "cone.h"
#include "newton.h"

namespace referee {

namespace {

// Iterations between two looks at the residual.
constexpr int BETWEEN = 10;

// Stiffness of the proximal steps, over that of a contact by itself, and how many
// are made before iterations go on.
constexpr double FIRST_STIFFNESS = 1e3, LARGEST_STIFFNESS = 1e9;
constexpr int PROXIMAL_STEPS = 20;

// What iterations keep of a contact.
struct Local {
    Mat3 inverse;
    double alpha = 0;
};

void iterate(const System &system, std::vector<Local> &locals, Impulses &impulses, Motion &motion) {
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
        const Row &row = system.rows[i];
        Vec3 &impulse = impulses[i];
        Vec3 speed = system.speed(i, motion);
        if (impulse[0] == 0 && speed[0] >= 0) {
            continue;
        }
        speed[0] += row.softness * impulse[0];
        const Vec3 next =
            solve_contact(row.delassus, locals[i].inverse, speed - row.delassus * impulse,
                          row.friction, locals[i].alpha);
        system.push(i, next - impulse, motion);
        impulse = next;
    }
}

} // namespace

Solution solve(const System &system, const Impulses &start, const Limits &limits) {
    Solution s;
    s.impulses = start;
    for (std::size_t i = 0; i < start.size(); ++i) {
        s.impulses[i] = onto_cone(start[i], system.rows[i].friction);
    }
    s.motion = system.motion(s.impulses);
    s.residual = residual(system, s.impulses, s.motion);
    std::vector<Local> locals(system.rows.size());
    for (std::size_t i = 0; i < locals.size(); ++i) {
        locals[i].inverse = system.rows[i].delassus.inverse();
    }
    const auto iterations = [&](int most) {
        for (int n = 1; n <= most && s.residual > limits.tolerance; ++n) {
            iterate(system, locals, s.impulses, s.motion);
            ++s.iterations;
            if (n % BETWEEN == 0 || n == most) {
                s.motion = system.motion(s.impulses);
                s.residual = residual(system, s.impulses, s.motion);
            }
        }
    };
    iterations(limits.iterations);
    if (s.residual <= limits.tolerance || limits.newton_steps == 0) {
        return s;
    }
    Newton newton(system);
    int left = limits.newton_steps;
    while (left > 0 && s.residual > limits.tolerance) {
        --left; // also where no step succeeds
        Solution next = s;
        double stiffness = FIRST_STIFFNESS;
        for (int n = 0; n < PROXIMAL_STEPS && next.residual > limits.tolerance; ++n) {
            const double precision = std::max(1e-13, 0.03 * next.residual);
            if (!newton.step(stiffness, precision, next.impulses, next.motion, left)) {
                break;
            }
            next.motion = system.motion(next.impulses);
            const double before = next.residual;
            next.residual = residual(system, next.impulses, next.motion);
            // Points that all but contradict each other ask for a very stiff one.
            stiffness *= next.residual < 0.5 * before ? 3 : 30;
            stiffness = std::min(stiffness, LARGEST_STIFFNESS);
        }
        if (next.residual < s.residual) {
            s = next;
        }
        s.newton_steps = limits.newton_steps - left;
        if (left > 0 && s.residual > limits.tolerance) {
            iterations(limits.iterations);
        }
    }
    return s;
}

} // namespace referee
