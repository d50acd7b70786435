// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball inside an ellipsoidal bowl, sliding without friction or rolling with spin: Fang (2022), Sec. 5.5.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The bowl is the inside of (x/a)² + (y/b)² + (z/c)² = 1, global axes. With Σ = diag(a, b, c) its points are
/// p = Σ s, |s| = 1, and the centre of the ball is r = p + R n:
///
///     n = -Σ⁻¹ s/ρ,  ρ = |Σ⁻¹ s|,  P = 1 - n nᵀ
///     ṅ = -P Σ⁻¹ ṡ/ρ,   n̈ = -P Σ⁻¹ s̈/ρ - 2 (ρ̇/ρ) ṅ - |ṅ|² n,   ρ̇ = -n·Σ⁻¹ ṡ
///
/// s is given by two coordinates q, the stereographic ones about the s_0 = e_3 at which a leg of the motion
/// begins, with e_1, e_2 perpendicular to it:
///
///     s = u - e_3,  u = 2 (q_1 e_1 + q_2 e_2 + e_3)/(1 + |q|²)
///
/// Each leg is a small part of a turn, far from the one point that q does not reach, so that the whole bowl can be
/// travelled. Everything is determined by q:
///
///     slide   r_qᵀ r̈ = r_qᵀ g                                               two equations for q̈
///     roll    r_q q̇ = R ω × n,    (J + m R²) ω̇ = m R n × g + m R² (n·ω) ṅ    five for q and ω
///
/// The second is the moment about the contact, J ω̇ = -R n × m (r̈ - g) with r̈ = R (ω̇ × n + ω × ṅ): the spin
/// n·ω̇ = 0. The attitude is a rotation vector on each leg, A = exp(θ̃) A_0. The force is F = m (r̈ - g).
struct BallInBowl {
    Vec3 semi_axes = Vec3(4, 3, 2);  ///< a, b, c [m]
    double R = 0.5, m = 1;           ///< of the ball [m, kg]
    double J = 0.4 * m * R * R;      ///< [kg m²]
    double g = 9.81;                 ///< [m/s²], along -z

    /// The start is at t = 0
    struct InitialState {
        Vec3 p = Vec3(0, 0, -2);   ///< contact point, on the bowl [m]
        Vec3 rdot = Vec3::Zero();  ///< of the centre, tangent to the bowl [m/s]
        double spin = 0;           ///< n·ω [rad/s]; without friction the ball starts with ω = spin n
        Mat3 A = Mat3::Identity();
    };

    /// Of the lower half, above (x, y). InvalidInput outside of it.
    Vec3 point(double x, double y) const;
    /// Into the bowl, at the contact point p
    Vec3 normal(const Vec3& p) const;
    /// [J], of translation, rotation and height
    double energy(const Motion& ball) const;

    /// At these instants [s], ascending, none negative. InvalidInput for a ball that is not smaller than the
    /// smallest radius of curvature, and for a start that is not on the bowl or leaves it, beyond 1e-9 of R.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> roll(const InitialState& start, const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
