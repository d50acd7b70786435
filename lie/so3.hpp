// SPDX-License-Identifier: GPL-3.0-or-later
/// Rotations: the tilde map, exponential, logarithm and right Jacobian of SO(3).   Fang (2022), Sec. 3.1, 3.3

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace hilda::lie {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// The skew-symmetric ã with ã b = a × b.
inline Mat3 tilde(const Vec3& a)
{
    Mat3 a_tilde;
    // clang-format off
    a_tilde <<     0, -a.z(),  a.y(),
               a.z(),      0, -a.x(),
              -a.y(),  a.x(),      0;
    // clang-format on
    return a_tilde;
}

/// The vector of the skew-symmetric part of S: vee(tilde(a)) = a.
inline Vec3 vee(const Mat3& S) { return 0.5 * Vec3(S(2, 1) - S(1, 2), S(0, 2) - S(2, 0), S(1, 0) - S(0, 1)); }

/// The three functions of the angle that exp, its Jacobian and their inverses are made of. Near zero the
/// closed forms cancel, so below 0.5 rad they are summed as series; the first dropped term is under 1e-17.
struct RotationCoefficients {
    double sinc;   ///< sin x / x
    double cosc;   ///< (1 - cos x) / x²
    double sincc;  ///< (x - sin x) / x³

    /// x2 = x² [rad²], any non-negative number
    explicit RotationCoefficients(double x2)
    {
        if (x2 < 0.25) {
            cosc = series(
                x2, {1. / 2, 1. / 24, 1. / 720, 1. / 40320, 1. / 3628800, 1. / 479001600, 1. / 87178291200});
            sincc = series(x2, {1. / 6, 1. / 120, 1. / 5040, 1. / 362880, 1. / 39916800, 1. / 6227020800,
                                1. / 1307674368000});
            sinc = 1 - x2 * sincc;
        } else {
            const double x = std::sqrt(x2), s = std::sin(x), half = std::sin(x / 2);
            sinc = s / x;
            cosc = 2 * half * half / x2;
            sincc = (1 - sinc) / x2;
        }
    }

private:
    /// Σ (-x²)ⁿ aₙ
    static constexpr double series(double x2, const std::array<double, 7>& a)
    {
        return a[0] - x2 * (a[1] - x2 * (a[2] - x2 * (a[3] - x2 * (a[4] - x2 * (a[5] - x2 * a[6])))));
    }
};

/// exp(θ̃): the rotation by the angle |θ| [rad] about θ.                                  Eqs. 3.10, 3.11
inline Mat3 exp(const Vec3& theta)
{
    const RotationCoefficients c(theta.squaredNorm());
    Mat3 A = c.cosc * theta * theta.transpose();
    const double cosine = 1 - c.cosc * theta.squaredNorm();
    A.diagonal().array() += cosine;
    const Vec3 s = c.sinc * theta;
    A(2, 1) += s.x(), A(1, 2) -= s.x();
    A(0, 2) += s.y(), A(2, 0) -= s.y();
    A(1, 0) += s.z(), A(0, 1) -= s.z();
    return A;
}

/// The rotation vector θ with exp(θ̃) = A and |θ| ≤ π [rad]; at π one of the two signs.
Vec3 log(const Mat3& A);

/// J_r(θ) with exp(θ + δ) = exp(θ) exp(J_r(θ) δ) + O(δ²).
inline Mat3 right_jacobian(const Vec3& theta)
{
    const RotationCoefficients c(theta.squaredNorm());
    const Mat3 theta_tilde = tilde(theta);
    return Mat3::Identity() - c.cosc * theta_tilde + c.sincc * theta_tilde * theta_tilde;
}

/// J_r(θ)⁻¹. Singular at |θ| = 2π, where it is not finite.
Mat3 right_jacobian_inverse(const Vec3& theta);

/// The rotation nearest to B in the Frobenius norm (B = A S with S symmetric positive definite).
Mat3 nearest_rotation(const Mat3& B);

/// ‖AᵀA - I‖_F, zero for a rotation
inline double orthogonality_error(const Mat3& A) { return (A.transpose() * A - Mat3::Identity()).norm(); }

}  // namespace hilda::lie
