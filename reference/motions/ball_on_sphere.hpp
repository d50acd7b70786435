// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball that moves down a fixed sphere and lifts off: sliding, rolling, or rolling until it slips.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

#include <limits>

namespace hilda::reference {

/// Motion of the ball up to the lift-off and in free flight. In flight F_N = F_t = 0, and n, p and ā are
/// those of the closest points.
struct DescentResult {
    std::vector<ContactInstant> instant;
    double t_slip =
        std::numeric_limits<double>::infinity();  ///< start of slipping [s]; infinite if it does not slip
    double t = 0;                                 ///< time of lift-off [s]
    Motion body;                                  ///< state at lift-off, with the acceleration of flight
};

/// The sphere is centred at the origin. The ball starts on top of it at t = 0 with the velocity v_0 along y
/// and A = 1. With the angle θ from the top, n = (0, sin θ, cos θ), the centre at (R + r) n and its velocity
/// v = (R + r) θ̇,
///
///     m v̇ = m g sin θ - F_t,    F_N = m g cos θ - m v²/(R + r),    J ω̇ = r F_t
///
/// where ω is the angular velocity about -x and F_t opposes v:
///
///     slide        F_t = 0                       lift-off at cos θ = 2/3 + v_0²/(3 g (R + r))
///     roll         F_t = J/(J + m r²) m g sin θ,  (3 + k) cos θ = 2 + (1 + k) v_0²/(g (R + r)) at lift-off,
///                  k = J/(m r²)
///     stick_slip   rolls while F_t ≤ μ F_N, then slips with F_t = μ F_N until lift-off at F_N = 0
///
/// During slip the equation of motion is linear in v² as a function of θ. With a constant C its solution is
///
///     v² = C e^(2μθ) - 2 g (R + r) ((1 - 2μ²) cos θ + 3μ sin θ)/(1 + 4μ²)
///
/// The friction required for rolling increases while F_N decreases to zero. With a finite μ the ball
/// therefore slips before it lifts off. It does not stick again, because v - rω increases. In flight ω is
/// constant.
struct BallOnSphere {
    double R = 1;                ///< radius of the fixed sphere [m]
    double r = 0.3, m = 1;       ///< radius and mass of the ball [m, kg]
    double J = 0.4 * m * r * r;  ///< [kg m²]
    double g = 9.81;             ///< [m/s²], along -z
    double v_0 = 0.2;            ///< [m/s], positive; at √(g (R + r)) or above, lift-off is at t = 0

    /// cos θ at lift-off, in closed form
    double slide_cosine() const;
    double roll_cosine() const;
    /// Time of lift-off [s] from the energy integral: t = ∫ (R + r) dθ/v(θ)
    double slide_time() const;
    double roll_time() const;

    /// Motion at ascending instants [s], none negative, and the lift-off, also if it is after the last
    /// instant. Throws lie::InvalidInput if a parameter is not positive or the instants do not ascend.
    DescentResult slide(const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;
    DescentResult roll(const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;
    DescentResult stick_slip(double mu, const std::vector<double>& instants,
                             const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
