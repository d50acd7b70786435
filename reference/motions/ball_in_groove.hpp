// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball that slides without friction inside a torus (a circular groove).

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// The axis of the torus is the global z axis. Its centre circle has the radius R_t and is at z = 0, and its
/// tube has the radius a. The centre of the ball moves on the torus with the tube radius q = a - R. With the
/// angle φ about the axis and the angle β from the bottom of the tube, positive outwards,
///
///     r = P e_r - q cos β e_z,  P = R_t + q sin β,    n = -(sin β e_r - cos β e_z)
///
///     q β̈ = P φ̇² cos β - g sin β,    P φ̈ = -2 q β̇ φ̇ cos β      (L_z = m P² φ̇ is constant)
///     F_N = m (q β̇² + P φ̇² sin β + g cos β)
///
/// Steady orbit at constant β: φ̇² = g tan β/(R_t + q sin β), F_N = m g/cos β.
struct BallInGroove {
    double R_t = 2, a = 1;       ///< centre circle and tube of the torus [m]
    double R = 0.4, m = 1;       ///< radius and mass of the ball [m, kg]
    double J = 0.4 * m * R * R;  ///< [kg m²]; no moment acts on the ball
    double g = 9.81;             ///< [m/s²], along -z

    /// State at t = 0, with φ = 0 and A = 1
    struct InitialState {
        double beta = 0.5;               ///< [rad]
        double betadot = 0, phidot = 0;  ///< [rad/s]
        Vec3 omega = Vec3::Zero();       ///< angular velocity of the ball, global, constant [rad/s]
    };

    /// φ̇ of the steady orbit at β [rad/s], 0 ≤ β < π/2
    double steady_rate(double beta) const;

    /// Motion at ascending instants [s], none negative. Throws lie::InvalidInput unless R < a < R_t and
    /// radius, mass and inertia are positive, and if the instants do not ascend.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
