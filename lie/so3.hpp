// SPDX-License-Identifier: GPL-3.0-or-later
/// Rotations: tilde map, exponential map, logarithm and right Jacobian of SO(3).  Fang (2022), Secs. 3.1, 3.3

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace hilda::lie {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// The skew-symmetric matrix ã with ã b = a × b.
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

/// The scalar functions of the angle x in exp, its right Jacobian and the inverses of both.
///
/// The closed forms lose digits by cancellation near zero. Below 0.5 rad they are replaced by power series,
/// whose first neglected term is below 1e-17.
struct RotationCoefficients {
    double sinc;   ///< (sin x)/x
    double cosc;   ///< (1 - cos x)/x²
    double sincc;  ///< (x - sin x)/x³

    /// x2 = x² ≥ 0 [rad²]
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
Mat3 exp(const Vec3& theta);

/// The rotation vector θ with exp(θ̃) = A and |θ| ≤ π [rad]. For |θ| = π both θ and -θ are solutions; one is
/// returned.
Vec3 log(const Mat3& A);

/// The right Jacobian: exp((θ + δ)~) = exp(θ̃) exp((J_r(θ) δ)~) + O(δ²),
///
///     J_r(θ) = I - (1 - cos x)/x² θ̃ + (x - sin x)/x³ θ̃²,    x = |θ|
Mat3 right_jacobian(const Vec3& theta);

/// J_r(θ)⁻¹ for |θ| < 2π. J_r is singular at |θ| = 2π; the result has no correct digits there.
Mat3 right_jacobian_inverse(const Vec3& theta);

/// The rotation nearest to B in the Frobenius norm (B = A S with S symmetric positive definite).
Mat3 nearest_rotation(const Mat3& B);

/// The rotation nearest to A, to first order in AᵀA - I (one Newton step of the polar decomposition).
///
/// Applied after every step, it removes the rounding errors of A: ‖AᵀA - I‖ remains a few ulp for any number
/// of steps.
Mat3 orthonormalised(const Mat3& A);

/// ‖AᵀA - I‖_F. Zero for a rotation.
double orthogonality_error(const Mat3& A);

}  // namespace hilda::lie
