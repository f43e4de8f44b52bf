#include "restitution.h"

#include "cone.h"

#include <cmath>
#include <limits>

namespace referee {

namespace {

constexpr double FREE = std::numeric_limits<double>::infinity();

// Sweeps over contacts whose normal impulse may not exceed `most`.
int solve_bounded(const System &system, const std::vector<double> &most, const Limits &limits,
                  Impulses &impulses, Motion &motion) {
    std::vector<double> alpha(system.rows.size(), 0);
    impulses.assign(system.rows.size(), Vec3::Zero());
    motion = system.free;
    for (int n = 1; n <= limits.sweeps; ++n) {
        double changed = 0, all = 0;
        for (std::size_t i = 0; i < system.rows.size(); ++i) {
            const Row &row = system.rows[i];
            Vec3 speed = system.speed(i, motion);
            speed[0] += row.softness * impulses[i][0];
            const Vec3 q = speed - row.delassus * impulses[i];
            Vec3 next =
                solve_contact(row.delassus, row.delassus.inverse(), q, row.friction, alpha[i]);
            if (next[0] > most[i]) {
                next = solve_loaded_contact(row.delassus, q, row.friction, most[i]);
            }
            const Vec3 more = next - impulses[i];
            system.push(i, more, motion);
            impulses[i] = next;
            changed += more.dot(row.delassus * more);
            all += next.dot(row.delassus * next);
        }
        if (changed <= limits.tolerance * limits.tolerance * all) {
            return n;
        }
    }
    return limits.sweeps;
}

} // namespace

Law compression_and_restitution(double restitution, double threshold) {
    return [=](const Step &step, const Limits &limits) {
        Solution closing = inelastic(step, limits);
        const auto &rows = step.system.rows;
        std::vector<double> approach(rows.size(), 0), most(rows.size(), FREE);
        bool any = false;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const double speed = rows[i].fixed[0] - step.system.speed(i, step.before)[0];
            if (closing.impulses[i][0] > 0 && speed > threshold) {
                approach[i] = speed;
                any = true;
            }
        }
        if (!any || restitution <= 0) {
            return closing;
        }
        System system = step.system;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (approach[i] > 0) {
                Row &row = system.rows[i];
                row.fixed[0] = 0;
                row.delassus(0, 0) -= row.softness;
                row.softness = 0;
            }
        }
        Solution s = solve(system, closing.impulses, limits);
        s.sweeps += closing.sweeps;
        s.newton_steps += closing.newton_steps;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            Row &row = system.rows[i];
            if (approach[i] > 0) {
                row.fixed[0] = -restitution * approach[i];
                most[i] = restitution * s.impulses[i][0];
            } else if (s.impulses[i][0] > 0) {
                row.fixed[0] = std::max(0.0, row.fixed[0] - system.speed(i, s.motion)[0]);
                row.delassus(0, 0) -= row.softness;
                row.softness = 0;
            }
        }
        system.free = s.motion;
        Impulses more;
        s.sweeps += solve_bounded(system, most, limits, more, s.motion);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            s.impulses[i] += more[i];
        }
        return s;
    };
}

} // namespace referee
