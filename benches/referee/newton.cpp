// Solves a contact problem by Newton's method on the velocities of the bodies.
#include "newton.h"

#include "cone.h"

#include <Eigen/SparseCore>
#include <Eigen/UmfPackSupport>

#include <cmath>
#include <map>

namespace referee {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// A proximal step that takes more does not get there.
constexpr int MOST_STEPS = 25;

// An error of F, over what contacts change, that may be rounding.
constexpr double ROUNDING = 1e-10;

struct Response {
    Vec3 impulse;
    Mat3 slope; // −dλ/du
};

// What a contact answers to a speed, about a centre, and how it changes.
Response respond(const Row &row, const Vec3 &centre, const Vec3 &speed, double rho) {
    Response r{Vec3::Zero(), Mat3::Zero()};
    // Softness: λ_n = max(0, λ⁰_n − ρ (u_n + γ λ_n)).
    const double soft = 1 / (1 + rho * row.softness);
    const double n = (centre[0] - rho * speed[0]) * soft;
    if (n <= 0) {
        return r;
    }
    r.impulse[0] = n;
    r.slope(0, 0) = rho * soft;
    const Vec2 t(centre[1] - rho * speed[1], centre[2] - rho * speed[2]);
    const double size = t.norm(), most = row.friction * n;
    if (size <= most) {
        r.impulse.tail<2>() = t;
        r.slope(1, 1) = r.slope(2, 2) = rho;
        return r;
    }
    const Vec2 along = t / size;
    r.impulse.tail<2>() = along * most;
    r.slope.bottomRightCorner<2, 2>() =
        (Eigen::Matrix2d::Identity() - along * along.transpose()) * (rho * most / size);
    r.slope.block<2, 1>(1, 0) = along * (row.friction * rho * soft);
    return r;
}

double norm(const Motion &m) {
    double sum = 0;
    for (const Vec6 &v : m) {
        sum += v.squaredNorm();
    }
    return std::sqrt(sum);
}

} // namespace

struct Newton::Work {
    // Blocks of the matrix: of each body, and of each pair that touches.
    std::map<std::pair<int, int>, std::size_t> index;
    std::vector<std::pair<int, int>> place;
    std::vector<Mat6> blocks;
    Sparse matrix;
    Eigen::UmfPackLU<Sparse> lu;
    bool analysed = false;

    std::size_t at(int a, int b) {
        const auto [found, is_new] = index.try_emplace({a, b}, place.size());
        if (is_new) {
            place.emplace_back(a, b);
        }
        return found->second;
    }
    void factorize(const System &system, const std::vector<Response> &responses);
};

Newton::Newton(const System &system) : system_(system), work_(std::make_unique<Work>()) {
    for (std::size_t i = 0; i < system.free.size(); ++i) {
        work_->at(static_cast<int>(i), static_cast<int>(i));
    }
    for (const Row &row : system.rows) {
        if (row.a >= 0 && row.b >= 0) {
            work_->at(row.a, row.b);
            work_->at(row.b, row.a);
        }
    }
    work_->blocks.resize(work_->place.size());
}

Newton::~Newton() = default;

// J = 1 + Σ Jᵀ (−dλ/du) J over the contacts.
void Newton::Work::factorize(const System &system, const std::vector<Response> &responses) {
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        const bool diagonal = place[k].first == place[k].second;
        blocks[k] = (diagonal ? 1.0 : 0.0) * Mat6::Identity();
    }
    for (std::size_t i = 0; i < system.rows.size(); ++i) {
        const Row &row = system.rows[i];
        const Mat3 &slope = responses[i].slope;
        const auto add = [&](int a, const Mat36 &ja, int b, const Mat36 &jb) {
            if (a >= 0 && b >= 0) {
                blocks[at(a, b)].noalias() += ja.transpose() * slope * jb;
            }
        };
        if (slope(0, 0) > 0) {
            add(row.a, row.ja, row.a, row.ja);
            add(row.b, row.jb, row.b, row.jb);
            add(row.a, row.ja, row.b, row.jb);
            add(row.b, row.jb, row.a, row.ja);
        }
    }
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(36 * blocks.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        for (int r = 0; r < 6; ++r) {
            for (int c = 0; c < 6; ++c) {
                triplets.emplace_back(6 * place[k].first + r, 6 * place[k].second + c,
                                      blocks[k](r, c));
            }
        }
    }
    const auto size = static_cast<Eigen::Index>(6 * system.free.size());
    matrix.resize(size, size);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    if (!analysed) {
        lu.analyzePattern(matrix);
        analysed = true;
    }
    lu.factorize(matrix);
}

bool Newton::step(double stiffness, double precision, Impulses &centre, Motion &motion,
                  int &steps) {
    const auto &rows = system_.rows;
    std::vector<double> rho(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rho[i] = stiffness * 3 / (rows[i].delassus.trace() - rows[i].softness);
    }
    std::vector<Response> responses(rows.size());
    // Speeds at the start and what is added to them stay apart: times a high
    // stiffness, the rounding of their sum would be felt.
    std::vector<Vec3> speeds(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        speeds[i] = system_.speed(i, motion);
    }
    const auto evaluate = [&](const Motion &added) {
        Motion f = motion;
        for (std::size_t i = 0; i < f.size(); ++i) {
            f[i] += added[i] - system_.free[i];
        }
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Vec3 speed = speeds[i] + (system_.speed(i, added) - rows[i].fixed);
            responses[i] = respond(rows[i], centre[i], speed, rho[i]);
            system_.push(i, -responses[i].impulse, f);
        }
        return f;
    };
    Motion added(motion.size(), Vec6::Zero());
    Motion f = evaluate(added);
    double error = norm(f);
    const double scale = distance(motion, system_.free);
    for (int n = 0; error > precision * scale; ++n) {
        if (n == MOST_STEPS || steps <= 0) {
            return false;
        }
        --steps;
        work_->factorize(system_, responses);
        if (work_->lu.info() != Eigen::Success) {
            return false;
        }
        Eigen::VectorXd rhs(6 * static_cast<Eigen::Index>(f.size()));
        for (std::size_t i = 0; i < f.size(); ++i) {
            rhs.segment<6>(6 * static_cast<Eigen::Index>(i)) = f[i];
        }
        const Eigen::VectorXd direction = work_->lu.solve(rhs);
        // The longest of the halved steps that makes the error smaller.
        bool better = false;
        for (double share = 1; share > 1e-3 && !better; share *= 0.5) {
            Motion next = added;
            for (std::size_t i = 0; i < next.size(); ++i) {
                next[i] -= share * direction.segment<6>(6 * static_cast<Eigen::Index>(i));
            }
            const Motion f_next = evaluate(next);
            const double error_next = norm(f_next);
            better = error_next < (1 - 1e-4 * share) * error;
            if (better) {
                added = next;
                f = f_next;
                error = error_next;
            }
        }
        if (!better) {
            // Rounding ends it, too.
            evaluate(added);
            if (error > ROUNDING * scale) {
                return false;
            }
            break;
        }
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        centre[i] = responses[i].impulse;
    }
    return true;
}

} // namespace referee
