// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball inside an ellipsoidal bowl, sliding without friction or rolling with spin.      Fang (2022), Sec. 5.5

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The bowl is the inside of the ellipsoid (x/a)² + (y/b)² + (z/c)² = 1 in global axes. With Σ = diag(a, b,
/// c) its points are p = Σ s, |s| = 1, and the centre of the ball is r = p + R n:
///
///     n = -Σ⁻¹ s/ρ,  ρ = |Σ⁻¹ s|,  P = 1 - n nᵀ
///     ṅ = -P Σ⁻¹ ṡ/ρ,   n̈ = -P Σ⁻¹ s̈/ρ - 2 (ρ̇/ρ) ṅ - |ṅ|² n,   ρ̇ = -n·Σ⁻¹ ṡ
///
/// The coordinates of s are stereographic coordinates q about the point e_3, with e_1, e_2 perpendicular to
/// it:
///
///     s = u - e_3,  u = 2 (q_1 e_1 + q_2 e_2 + e_3)/(1 + |q|²)
///
/// The chart is reset to e_3 = s after a small rotation, so the motion stays far from its singular point s =
/// -e_3 and can cover the whole ellipsoid. The equations of motion are
///
///     slide   r_qᵀ r̈ = r_qᵀ g                                               two equations for q̈
///     roll    r_q q̇ = R ω × n,    (J + m R²) ω̇ = m R n × g + m R² (n·ω) ṅ    five for q and ω
///
/// The equation of rolling is the moment balance about the contact point, J ω̇ = -R n × m (r̈ - g) with r̈ =
/// R (ω̇ × n + ω × ṅ) and n·ω̇ = 0. The attitude is integrated as a rotation vector, A = exp(θ̃) A_0, reset
/// together with the chart. The contact force is F = m (r̈ - g).
struct BallInBowl {
    Vec3 semi_axes = Vec3(4, 3, 2);  ///< a, b, c [m]
    double R = 0.5, m = 1;           ///< radius and mass of the ball [m, kg]
    double J = 0.4 * m * R * R;      ///< [kg m²]
    double g = 9.81;                 ///< [m/s²], along -z

    /// State at t = 0
    struct InitialState {
        Vec3 p = Vec3(0, 0, -2);   ///< contact point, on the bowl [m]
        Vec3 rdot = Vec3::Zero();  ///< velocity of the centre, tangent to the bowl [m/s]
        double spin = 0;           ///< n·ω [rad/s]; in slide() ω = spin n
        Mat3 A = Mat3::Identity();
    };

    /// Point of the lower half of the bowl at (x, y) [m]. Throws lie::InvalidInput if there is none.
    Vec3 point(double x, double y) const;
    /// Inward unit normal at the point p of the bowl
    Vec3 normal(const Vec3& p) const;
    /// Kinetic plus potential energy [J]
    double energy(const Motion& ball) const;

    /// Motion at ascending instants [s], none negative. Throws lie::InvalidInput if a length, mass or inertia
    /// is not positive, R is not smaller than the smallest radius of curvature, p is farther than 1e-9 R from
    /// the bowl, the normal velocity exceeds 1e-9 |ṙ|, or the instants do not ascend.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> roll(const InitialState& start, const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
