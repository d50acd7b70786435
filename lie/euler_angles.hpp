// SPDX-License-Identifier: GPL-3.0-or-later
/// Euler angles ε = (θ, φ, ψ) in the z-x-z sequence: A = R_z(θ) R_x(φ) R_z(ψ).        Fang (2022), Eq. 2.1b
/// Singular for sin φ = 0: θ and ψ are then rotations about the same axis.

#pragma once

#include "lie/so3.hpp"

namespace hilda::lie {

/// A(ε)
inline Mat3 rotation(const Vec3& eps)
{
    using Eigen::AngleAxisd;
    return (AngleAxisd(eps[0], Vec3::UnitZ()) * AngleAxisd(eps[1], Vec3::UnitX()) *
            AngleAxisd(eps[2], Vec3::UnitZ()))
        .toRotationMatrix();
}

/// B(ε), with ω̄ = B(ε) ε̇ and δθ̄ = B(ε) δε; body frame
inline Mat3 B(const Vec3& eps)
{
    const double s_phi = std::sin(eps[1]), c_phi = std::cos(eps[1]);
    const double s_psi = std::sin(eps[2]), c_psi = std::cos(eps[2]);
    Mat3 B;
    // clang-format off
    B << s_phi * s_psi,  c_psi, 0,
         s_phi * c_psi, -s_psi, 0,
                 c_phi,      0, 1;
    // clang-format on
    return B;
}

/// The Euler angles of a rotation, with 0 ≤ φ ≤ π. For sin φ = 0 only θ ± ψ is determined; the result then
/// has ψ = 0.
inline Vec3 euler_angles(const Mat3& A)
{
    const double phi = std::atan2(std::hypot(A(2, 0), A(2, 1)), A(2, 2));
    if (std::hypot(A(2, 0), A(2, 1)) == 0) return {std::atan2(A(1, 0), A(0, 0)), phi, 0};
    return {std::atan2(A(0, 2), -A(1, 2)), phi, std::atan2(A(2, 0), A(2, 1))};
}

/// Distance [rad] of the nutation angle φ from the nearest singular value kπ.
inline double distance_to_singular_set(const Vec3& eps)
{
    constexpr double pi = 3.14159265358979323846;
    return std::abs(std::remainder(eps[1], pi));
}

}  // namespace hilda::lie
