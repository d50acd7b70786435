// SPDX-License-Identifier: GPL-3.0-or-later
/// An ellipsoid on the plane z = 0, sliding without friction or rolling: pebbles, eggs, the rattleback.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The surface is āᵀ Σ⁻² ā = 1 in the body frame, Σ = diag(a, b, c) about the centre of mass; J̄ may be turned
/// against it. With ē = Aᵀ ẑ, which changes by ē̇ = ē × ω̄, the contact point and the height of the centre are
///
///     ā = -Σ² ē/ρ,  ρ = √(ēᵀ Σ² ē),    r_z = ρ,  ṙ_z = -ā·ē̇
///     ā̇ = -(Σ² ē̇ + ρ̇ ā)/ρ
///
/// slide: only F_N acts, m r̈_z = F_N - m g, and r̈_z = -ā̇·ē̇ - ā·(ē̇ × ω̄) - (ā × ē)·ω̄̇ . With b̄ = ā × ē
///
///     (J̄ + m b̄ b̄ᵀ) ω̄̇ = -ω̄ × J̄ ω̄ + m (g - ā̇·ē̇ - ā·(ē̇ × ω̄)) b̄
///
/// and the velocity along the plane, the energy and the vertical part of the angular momentum stay.
///
/// roll: ṙ = A (ā × ω̄), F = m (r̈ + g ẑ), moment about the centre ā × AᵀF:
///
///     (J̄ - m ã ã) ω̄̇ = -ω̄ × J̄ ω̄ + m ā × (ω̄ × (ā × ω̄) + ā̇ × ω̄ + g ē)
///
/// and the energy stays. The attitude is a rotation vector, A = A_0 exp(θ̃), on each leg of the motion, a part of a
/// turn.
struct EllipsoidOnPlane {
    Vec3 semi_axes = Vec3(0.3, 0.25, 0.15);  ///< a, b, c along the body's x, y, z [m]
    double m = 2;                            ///< [kg]
    Mat3 J_bar = homogeneous(semi_axes, m);  ///< about the centre [kg m²]
    double g = 9.81;                         ///< [m/s²], along -z

    /// m/5 diag(b² + c², c² + a², a² + b²)
    static Mat3 homogeneous(const Vec3& semi_axes, double m);

    /// The start is at t = 0. The height and its rate, and in rolling all of the velocity, follow.
    struct InitialState {
        Mat3 A = Mat3::Identity();
        Vec3 omega_bar = Vec3::Zero();  ///< [rad/s]
        double x = 0, y = 0;            ///< of the centre [m]
        double xdot = 0, ydot = 0;      ///< [m/s], taken by slide() only
    };

    /// [J]; and ẑ·A J̄ ω̄ [kg m²/s]
    double energy(const Motion& body) const;
    double L_z(const Motion& body) const;

    /// At these instants [s], ascending, none negative. InvalidInput for numbers that make no sense.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> roll(const InitialState& start, const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;

    /// Of rocking in the plane of y and z, about the shortest axis being upright, from rest at the angle θ_0 about
    /// x, by quadrature [s]. With μ = dρ/dθ = (b² - c²) sin θ cos θ/ρ and |ā|² = ρ² + μ²
    ///
    ///     slide  (J_x + m μ²) θ̇²/2 + m g ρ = m g ρ_0,    roll  (J_x + m |ā|²) θ̇²/2 + m g ρ = m g ρ_0
    ///
    /// and for θ_0 → 0, 2π √(J_x/(m g (b²/c - c))) and 2π √((J_x + m c²)/(m g (b²/c - c))). InvalidInput unless
    /// x is a principal axis, 0 < θ_0 < π/2 and b > c.
    double slide_period(double theta_0) const;
    double roll_period(double theta_0) const;
};

}  // namespace hilda::reference
