// Vectors and matrices of the referee (Eigen), SI units throughout.
#pragma once

#include <Eigen/Dense>

#include <vector>

namespace referee {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat3 = Eigen::Matrix3d;
using Mat36 = Eigen::Matrix<double, 3, 6>;
using Quat = Eigen::Quaterniond;

// One velocity of six components per body.
using Motion = std::vector<Vec6, Eigen::aligned_allocator<Vec6>>;
// One impulse per contact point: along the normal and both tangents.
using Impulses = std::vector<Vec3>;

// The symmetric root of a positive semi-definite matrix.
inline Mat3 symmetric_root(const Mat3 &m) {
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.compute(m);
    const Vec3 roots = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
    return eigen.eigenvectors() * roots.asDiagonal() * eigen.eigenvectors().transpose();
}

// Two unit vectors that complete a unit normal to a right-handed frame.
inline void tangents_of(const Vec3 &normal, Vec3 &first, Vec3 &second) {
    const Vec3 away = std::abs(normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
    first = normal.cross(away).normalized();
    second = normal.cross(first);
}

} // namespace referee
