// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball that slides without friction in a round groove: the inside of a torus.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The torus lies flat about the global z, its middle circle of radius R_t at z = 0, its tube of radius a. The
/// centre of the ball is on a torus too, with the tube q = a - R: at the angle φ round the axis and β from the
/// bottom outwards,
///
///     r = P e_r - q cos β e_z,  P = R_t + q sin β,    n = -(sin β e_r - cos β e_z)
///
///     q β̈ = P φ̇² cos β - g sin β,    P φ̈ = -2 q β̇ φ̇ cos β      (L_z = m P² φ̇ stays)
///     F_N = m (q β̇² + P φ̇² sin β + g cos β)
///
/// Steady at a constant β: φ̇² = g tan β/(R_t + q sin β), F_N = m g/cos β.
struct BallInGroove {
    double R_t = 2, a = 1;       ///< of the torus [m]
    double R = 0.4, m = 1;       ///< of the ball [m, kg]
    double J = 0.4 * m * R * R;  ///< [kg m²]; nothing turns the ball
    double g = 9.81;             ///< [m/s²], along -z

    /// The start is at t = 0 at φ = 0, with A = 1
    struct InitialState {
        double beta = 0.5;               ///< [rad]
        double betadot = 0, phidot = 0;  ///< [rad/s]
        Vec3 omega = Vec3::Zero();       ///< of the ball [rad/s], stays
    };

    /// φ̇ of the steady orbit at β, 0 ≤ β < π/2 [rad/s]
    double steady(double beta) const;

    /// At these instants [s], ascending, none negative. InvalidInput unless R < a < R_t and for numbers that make
    /// no sense.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
