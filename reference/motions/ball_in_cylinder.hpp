// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball inside a vertical cylinder, sliding without friction or rolling, in closed form.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The axis of the cylinder is the global z axis. The centre of the ball is r = d e_r + z e_z with d = ρ - R
/// and e_r = (cos Ωt, sin Ωt, 0). The inward normal is n = -e_r. No force acts along e_θ, so Ω is constant
/// and F_N = m Ω² d.
///
///     slide   z̈ = -g, ω constant
///     roll    ż = R ω_θ,  ω_z = -dΩ/R,  and from the moment balance about the contact point
///             (J + m R²) ω̇ = m R n × g + m R² (n·ω) ṅ
///
///             ω̇_r = Ω ω_θ,    ω̇_θ = -β g/R - (1 - β) Ω ω_r,    β = m R²/(J + m R²)
///             z = (ż_0/ν) sin νt + z_eq (1 - cos νt),  ν = Ω √(1 - β)
///             z_eq = -β g/ν² - R ω_r0/Ω,  ω_r = ω_r0 + Ω z/R
///
/// The friction force is F_t = m (z̈ + g) e_z. The rolling ball does not fall: its height oscillates at ν,
/// which is √(2/7) |Ω| for a homogeneous ball.
struct BallInCylinder {
    double rho = 2;              ///< radius of the cylinder [m]
    double R = 0.5, m = 1;       ///< radius and mass of the ball [m, kg]
    double J = 0.4 * m * R * R;  ///< [kg m²]
    double g = 9.81;             ///< [m/s²], along -z
    double Omega = 3;            ///< angular velocity of the centre about the axis [rad/s], not zero
    double zdot = 0;             ///< at t = 0 [m/s]
    double spin = 0;             ///< n·ω at t = 0 [rad/s]; in slide() ω = spin n(0)

    double nu() const;    ///< angular frequency of rolling [rad/s]
    double z_eq() const;  ///< mean height of rolling [m]; z is between 0 and 2 z_eq if zdot = 0

    /// Motion at ascending instants [s], none negative, with A = 1, z = 0 and e_r = e_x at t = 0. In roll()
    /// the attitude is integrated numerically from the closed form of ω(t). Throws lie::InvalidInput if a
    /// length, mass or inertia is not positive, R ≥ rho, Omega = 0, or (roll only) the instants do not
    /// ascend.
    std::vector<ContactInstant> slide(const std::vector<double>& instants) const;
    std::vector<ContactInstant> roll(const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
