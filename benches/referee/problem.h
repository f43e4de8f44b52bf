// A contact problem on velocity level, as somebody hands it to the referee, and
// the same in coordinates in which its kinetic norm is the Euclidean one.
//
//   v   = v_free + M⁻¹ Hᵀ λ
//   u   = H v                               at every contact point
//   0 ≤ u_n − target + γ λ_n  ⊥  λ_n ≥ 0    Signorini, with softness γ
//   |λ_t| ≤ μ λ_n,  λ_t = −μ λ_n u_t / |u_t| where u_t ≠ 0    Coulomb
#pragma once

#include "algebra.h"

#include <iosfwd>
#include <string>

namespace referee {

struct ProblemBody {
    double inverse_mass = 0; // 0: static or kinematic
    Mat3 inverse_inertia = Mat3::Zero();
    Vec6 free = Vec6::Zero();  // velocity without contact impulses: linear, angular
    Vec6 found = Vec6::Zero(); // velocity that somebody found
};

// Rows of `axes` are the normal, which leads from B to A, and two tangents; those
// of `moments_a` and `moments_b` the moments that unit impulses along them have on
// A and B, r × axis. Impulses act on A, their opposites on B.
struct ProblemContact {
    int a = 0, b = 0;
    Mat3 axes, moments_a, moments_b;
    double friction = 0, target = 0, softness = 0;
    Vec3 found = Vec3::Zero(); // impulse that somebody found, along the axes

    // Sets the axes by the normal, and the moments by arms from the centres of mass.
    void set_geometry(const Vec3 &normal, const Vec3 &arm_a, const Vec3 &arm_b);
};

struct Problem {
    std::string scene, engine;
    double time = 0, step = 0;
    std::vector<ProblemBody> bodies;
    std::vector<ProblemContact> contacts;
};

// Problems in JSON, one a line: {scene, engine, time_s, step_s, bodies: [[inverse
// mass; inverse inertia xx, yy, zz, xy, xz, yz; 6 numbers of free, 6 of found]],
// contacts: [[a, b; of the normal and each tangent the direction and the moments on
// a and b; friction, target, softness; 3 of found]]}. Any coherent units.
Problem read_problem(const std::string &line);
void write_problem(const Problem &problem, std::ostream &out);

// One contact point in scaled coordinates: u = ja·w_a + jb·w_b + fixed.
struct Row {
    int a, b; // -1: does not move
    Mat36 ja = Mat36::Zero(), jb = Mat36::Zero();
    Vec3 fixed = Vec3::Zero(); // velocity of static and kinematic bodies, minus the target
    Mat3 delassus;             // own block of H M⁻¹ Hᵀ, with softness
    double friction = 0, softness = 0;
};

// w = M^½ v for each body.
struct System {
    Motion free;
    std::vector<Row> rows;

    // Velocities that impulses give.
    Motion motion(const Impulses &impulses) const;
    // Relative velocity at a row, less the target; without softness.
    Vec3 speed(std::size_t row, const Motion &motion) const {
        const Row &r = rows[row];
        Vec3 u = r.fixed;
        if (r.a >= 0) {
            u.noalias() += r.ja * motion[static_cast<std::size_t>(r.a)];
        }
        if (r.b >= 0) {
            u.noalias() += r.jb * motion[static_cast<std::size_t>(r.b)];
        }
        return u;
    }
    void push(std::size_t row, const Vec3 &impulse, Motion &motion) const {
        const Row &r = rows[row];
        if (r.a >= 0) {
            motion[static_cast<std::size_t>(r.a)].noalias() += r.ja.transpose() * impulse;
        }
        if (r.b >= 0) {
            motion[static_cast<std::size_t>(r.b)].noalias() += r.jb.transpose() * impulse;
        }
    }
};

System scaled(const Problem &problem);
// Scaled velocities of the problem's bodies.
Motion scaled_motion(const Problem &problem, bool found);
Impulses found_impulses(const Problem &problem);
Motion unscaled(const Problem &problem, const Motion &motion);

double distance(const Motion &a, const Motion &b);
// Natural-map residual of impulses with the velocities that they give, over the
// norm of all that the contacts change; both in the kinetic norm.
double residual(const System &system, const Impulses &impulses, const Motion &motion);

// Errors of the bodies that move and are touched: each's distance from the
// reference over the root mean square of what contacts change.
std::vector<double> body_errors(const System &system, const Motion &reference, const Motion &found);

} // namespace referee
