// Hands a contact problem to the library Siconos, and takes its solution back.
#include "siconos.h"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <fc3d_Solvers.h>
#include <fc3d_compute_error.h>

#include <cmath>
#include <memory>

namespace referee {

namespace {

// The problem in Siconos' form: u = M λ + q with dense M = H M⁻¹ Hᵀ + γ.
struct Form {
    std::vector<double> matrix, q, friction;
    FrictionContactProblem problem;
    std::unique_ptr<NumericsMatrix, void (*)(NumericsMatrix *)> numerics{nullptr, [](auto *) {}};

    explicit Form(const System &system) {
        const std::size_t count = system.rows.size(), size = 3 * count;
        matrix.assign(size * size, 0); // column by column
        Motion still = system.free;
        for (Vec6 &v : still) {
            v.setZero();
        }
        for (std::size_t j = 0; j < count; ++j) {
            for (int k = 0; k < 3; ++k) {
                Motion pushed = still;
                system.push(j, Vec3::Unit(k), pushed);
                for (std::size_t i = 0; i < count; ++i) {
                    const Vec3 u = system.speed(i, pushed) - system.rows[i].fixed;
                    for (int m = 0; m < 3; ++m) {
                        matrix[(3 * j + static_cast<std::size_t>(k)) * size + 3 * i +
                               static_cast<std::size_t>(m)] = u[m];
                    }
                }
            }
            matrix[3 * j * size + 3 * j] += system.rows[j].softness;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 u = system.speed(i, system.free);
            q.insert(q.end(), {u[0], u[1], u[2]});
            friction.push_back(system.rows[i].friction);
        }
        const auto n = static_cast<int>(size);
        numerics = {NM_create_from_data(NM_DENSE, n, n, matrix.data()), [](NumericsMatrix *m) {
                        m->matrix0 = nullptr; // ours
                        NM_clear(m);
                        std::free(m);
                    }};
        problem = {3, static_cast<int>(count), numerics.get(), q.data(), friction.data()};
    }
};

std::vector<double> flat(const Impulses &impulses) {
    std::vector<double> out;
    for (const Vec3 &v : impulses) {
        out.insert(out.end(), {v[0], v[1], v[2]});
    }
    return out;
}

} // namespace

Solution solve_with_siconos(const System &system, const Impulses &start, double tolerance,
                            int iterations) {
    Form form(system);
    std::vector<double> reaction = flat(start), velocity(reaction.size(), 0);
    SolverOptions *options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = iterations;
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    fc3d_driver(&form.problem, reaction.data(), velocity.data(), options);
    Solution solution;
    solution.iterations = options->iparam[SICONOS_IPARAM_ITER_DONE];
    solver_options_delete(options);
    std::free(options);
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
        solution.impulses.emplace_back(reaction[3 * i], reaction[3 * i + 1], reaction[3 * i + 2]);
    }
    solution.motion = system.motion(solution.impulses);
    solution.residual = residual(system, solution.impulses, solution.motion);
    return solution;
}

double siconos_error(const System &system, const Impulses &impulses) {
    // As `fc3d_compute_error` adds it up, contact by contact: the dense form that this takes
    // needs 400 MB for 2400 contact points.
    const Motion motion = system.motion(impulses);
    double squares = 0, norm = 0, work[3];
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
        const Row &row = system.rows[i];
        Vec3 impulse = impulses[i], velocity = system.speed(i, motion);
        velocity[0] += row.softness * impulse[0];
        fc3d_unitary_compute_and_add_error(impulse.data(), velocity.data(), row.friction, &squares,
                                           work);
        norm += system.speed(i, system.free).squaredNorm();
    }
    return std::sqrt(norm > 0 ? squares / norm : squares);
}

} // namespace referee
