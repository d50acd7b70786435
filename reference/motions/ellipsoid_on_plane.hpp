// SPDX-License-Identifier: GPL-3.0-or-later
/// Ellipsoid on the plane z = 0, sliding without friction or rolling without slip, e.g. the rattleback.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The surface is āᵀ Σ⁻² ā = 1 in the body frame, with Σ = diag(a, b, c) and the origin at the centre of
/// mass. J̄ need not be diagonal. With ē = Aᵀ ẑ and ē̇ = ē × ω̄, the contact point and the height of the
/// centre are
///
///     ā = -Σ² ē/ρ,  ρ = √(ēᵀ Σ² ē),    r_z = ρ,  ṙ_z = -ā·ē̇
///     ā̇ = -(Σ² ē̇ + ρ̇ ā)/ρ
///
/// slide: m r̈_z = F_N - m g and r̈_z = -ā̇·ē̇ - ā·(ē̇ × ω̄) - (ā × ē)·ω̄̇ . With b̄ = ā × ē
///
///     (J̄ + m b̄ b̄ᵀ) ω̄̇ = -ω̄ × J̄ ω̄ + m (g - ā̇·ē̇ - ā·(ē̇ × ω̄)) b̄
///
/// The horizontal velocity, the energy and the vertical component of the angular momentum are constant.
///
/// roll: ṙ = A (ā × ω̄), contact force F = m (r̈ + g ẑ), moment about the centre ā × AᵀF:
///
///     (J̄ - m ã ã) ω̄̇ = -ω̄ × J̄ ω̄ + m ā × (ω̄ × (ā × ω̄) + ā̇ × ω̄ + g ē)
///
/// The energy is constant.
///
/// The attitude is integrated as a rotation vector, A = A_0 exp(θ̃), which is reset after at most about 1
/// rad.
struct EllipsoidOnPlane {
    Vec3 semi_axes = Vec3(0.3, 0.25, 0.15);  ///< a, b, c along the body's x, y, z [m]
    double m = 2;                            ///< [kg]
    Mat3 J_bar = homogeneous(semi_axes, m);  ///< about the centre [kg m²]
    double g = 9.81;                         ///< [m/s²], along -z

    /// Inertia of a homogeneous ellipsoid, m/5 diag(b² + c², c² + a², a² + b²) [kg m²]
    static Mat3 homogeneous(const Vec3& semi_axes, double m);

    /// State at t = 0. Height and vertical velocity follow from the contact, in rolling the whole velocity.
    struct InitialState {
        Mat3 A = Mat3::Identity();
        Vec3 omega_bar = Vec3::Zero();  ///< [rad/s]
        double x = 0, y = 0;            ///< centre [m]
        double xdot = 0, ydot = 0;      ///< [m/s], used by slide() only
    };

    /// Kinetic plus potential energy [J]
    double energy(const Motion& body) const;
    /// Vertical component of the angular momentum about the centre, ẑ·A J̄ ω̄ [kg m²/s]
    double L_z(const Motion& body) const;

    /// Motion at ascending instants [s], none negative. Throws lie::InvalidInput if a semi-axis or the mass
    /// is not positive, J̄ is not positive definite, A is not a rotation, or the instants do not ascend.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> roll(const InitialState& start, const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;

    /// Period [s] of rocking in the y-z plane about the position with the c axis vertical, released at rest
    /// at the angle θ_0 about x. With μ = dρ/dθ = (b² - c²) sin θ cos θ/ρ and |ā|² = ρ² + μ² the energy
    /// integrals are
    ///
    ///     slide  (J_x + m μ²) θ̇²/2 + m g ρ = m g ρ_0,    roll  (J_x + m |ā|²) θ̇²/2 + m g ρ = m g ρ_0
    ///
    /// For θ_0 → 0 the periods are 2π √(J_x/(m g (b²/c - c))) and 2π √((J_x + m c²)/(m g (b²/c - c))). Throws
    /// lie::InvalidInput unless x is a principal axis, 0 < θ_0 < π/2 and b > c.
    double slide_period(double theta_0) const;
    double roll_period(double theta_0) const;
};

}  // namespace hilda::reference
