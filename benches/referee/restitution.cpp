// Lets contacts rebound in the referee's time stepping.
#include "restitution.h"

#include "cone.h"

#include <cmath>
#include <limits>

namespace referee {

namespace {

constexpr double FREE = std::numeric_limits<double>::infinity();

// Iterations over contacts whose normal impulse may not exceed `most`.
int solve_bounded(const System &system, const std::vector<double> &most, const Limits &limits,
                  Impulses &impulses, Motion &motion) {
    std::vector<double> alpha(system.rows.size(), 0);
    impulses.assign(system.rows.size(), Vec3::Zero());
    motion = system.free;
    for (int n = 1; n <= limits.iterations; ++n) {
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
    return limits.iterations;
}

// Takes a contact's softness away and sets the target of its normal speed; walls stand still.
void set_rigid(Row &row, double target) {
    row.fixed[0] = -target;
    row.delassus(0, 0) -= row.softness;
    row.softness = 0;
}

} // namespace

Law compression_and_restitution(const ImpactRule &rule) {
    return [rule](const Step &step, const Solution &first, const Limits &limits) {
        const auto &rows = step.system.rows;
        // Those that take part: what is open after the first solution does not.
        System system = step.system;
        system.rows.clear();
        std::vector<std::size_t> taken;
        std::vector<double> approach;
        Impulses start;
        bool any = false;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            // Without the target, which is part of what is fixed.
            const double before = step.system.speed(i, step.before)[0] - rows[i].fixed[0];
            const double after = step.system.speed(i, first.motion)[0] - rows[i].fixed[0];
            const double gap = step.gaps[i] + step.length * after;
            const bool bears = first.impulses[i][0] > 0;
            if (!bears && gap > rule.closed_gap) {
                continue;
            }
            const bool impact = -before > rule.threshold && (bears || gap <= rule.met_gap);
            any = any || impact;
            taken.push_back(i);
            start.push_back(first.impulses[i]);
            approach.push_back(impact ? -before : 0);
            system.rows.push_back(rows[i]);
            if (impact) {
                set_rigid(system.rows.back(), 0);
            }
        }
        if (!any) {
            return first;
        }
        Solution s = solve(system, start, limits);
        s.iterations += first.iterations;
        s.newton_steps += first.newton_steps;
        // Worst of both: a step is solved when all of it is.
        s.residual = std::max(s.residual, first.residual);
        if (rule.restitution > 0) {
            std::vector<double> most(taken.size(), FREE);
            for (std::size_t k = 0; k < taken.size(); ++k) {
                Row &row = system.rows[k];
                if (approach[k] > 0) {
                    set_rigid(row, rule.restitution * approach[k]);
                    most[k] = rule.restitution * s.impulses[k][0];
                } else {
                    const double speed = system.speed(k, s.motion)[0] - row.fixed[0];
                    set_rigid(row, std::min(0.0, speed));
                }
            }
            system.free = s.motion;
            Impulses more;
            s.iterations += solve_bounded(system, most, limits, more, s.motion);
            for (std::size_t k = 0; k < taken.size(); ++k) {
                s.impulses[k] += more[k];
            }
        }
        Impulses all(rows.size(), Vec3::Zero());
        for (std::size_t k = 0; k < taken.size(); ++k) {
            all[taken[k]] = s.impulses[k];
        }
        s.impulses = std::move(all);
        return s;
    };
}

} // namespace referee
