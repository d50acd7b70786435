// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball inside a vertical cylinder, whose normal is horizontal everywhere: closed forms.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The axis of the cylinder is the global z. The centre is at r = d e_r + z e_z, d = ρ - R, in the direction
/// e_r = (cos Ωt, sin Ωt, 0), and the normal into the cylinder is n = -e_r. Nothing acts along e_θ, so that Ω
/// stays, and F_N = m Ω² d.
///
///     slide   z̈ = -g, ω constant
///     roll    ż = R ω_θ,  ω_z = -dΩ/R,  and the moment about the contact (J + m R²) ω̇ = m R n × g + m R² (n·ω) ṅ
///
///             ω̇_r = Ω ω_θ,    ω̇_θ = -β g/R - (1 - β) Ω ω_r,    β = m R²/(J + m R²)
///             z = (ż_0/ν) sin νt + z_eq (1 - cos νt),  ν = Ω √(1 - β)
///             z_eq = -β g/ν² - R ω_r0/Ω,  ω_r = ω_r0 + Ω z/R
///
/// Friction is F_t = m (z̈ + g) e_z: the ball does not fall, it goes up and down, ν = √(2/7) Ω when it is
/// homogeneous.
struct BallInCylinder {
    double rho = 2;              ///< of the cylinder [m]
    double R = 0.5, m = 1;       ///< of the ball [m, kg]
    double J = 0.4 * m * R * R;  ///< [kg m²]
    double g = 9.81;             ///< [m/s²], along -z
    double Omega = 3;            ///< of the centre about the axis [rad/s], not zero
    double zdot = 0;             ///< at the start [m/s]
    double spin = 0;             ///< n·ω at the start [rad/s], without friction all of ω

    double nu() const;    ///< of rolling [rad/s]
    double z_eq() const;  ///< of rolling [m]: it swings between 0 and 2 z_eq when ż = 0 at the start

    /// All but the attitude in rolling is closed; that is ω(t) integrated. At these instants [s], ascending, none
    /// negative; A = 1, z = 0, θ = 0 at t = 0. InvalidInput for numbers that make no sense.
    std::vector<ContactInstant> slide(const std::vector<double>& instants) const;
    std::vector<ContactInstant> roll(const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
