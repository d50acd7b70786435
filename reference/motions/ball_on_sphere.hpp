// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball that runs down a fixed sphere, leaves it, and falls: sliding, rolling, or rolling until it slips.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

#include <limits>

namespace hilda::reference {

/// A ball that has left: the motion while contact lasts, and after that. F_N = F_t = 0 in flight, where n, p and
/// ā go on to be those nearest to the sphere.
struct Departure {
    std::vector<ContactInstant> instant;
    double t_slip =
        std::numeric_limits<double>::infinity();  ///< [s], infinite when it does not begin to slip
    double t = 0;                                 ///< of lift-off [s]
    Motion body;                                  ///< then
};

/// The sphere is at the origin; the ball starts on top of it at v_0 towards y. With the angle θ from the top,
/// n = (0, sin θ, cos θ) and the centre at (R + r) n with velocity v = (R + r) θ̇,
///
///     m v̇ = m g sin θ - F_t,    F_N = m g cos θ - m v²/(R + r),    J ω̇ = r F_t
///
/// where ω is that about -x and F_t acts against v:
///
///     slide        F_t = 0                       leaves at cos θ = 2/3 + v_0²/(3 g (R + r))
///     roll         F_t = J/(J + m r²) m g sin θ,  (3 + k) cos θ = 2 + (1 + k) v_0²/(g (R + r)),  k = J/(m r²)
///     stick_slip   rolls while F_t ≤ μ F_N, then F_t = μ F_N as v - rω > 0, and leaves at F_N = 0
///
/// In slip the equation for v is linear in v² over θ, so that with a constant C
///
///     v² = C e^(2μθ) - 2 g (R + r) ((1 - 2μ²) cos θ + 3μ sin θ)/(1 + 4μ²)
///
/// The friction that rolling needs grows as F_N falls to zero, so that with a finite μ it always slips first, for
/// good: v - rω only grows. Then free fall, ω constant. The start is at t = 0 with A = 1.
struct BallOnSphere {
    double R = 1;                ///< of the fixed sphere [m]
    double r = 0.3, m = 1;       ///< of the ball [m, kg]
    double J = 0.4 * m * r * r;  ///< [kg m²]
    double g = 9.81;             ///< [m/s²], along -z
    double v_0 = 0.2;            ///< [m/s], positive; above √(g (R + r)) it leaves at once

    /// cos θ of lift-off, in closed form
    double slide_cosine() const;
    double roll_cosine() const;
    /// Time of lift-off [s], by quadrature of energy: t = ∫ (R + r) dθ/v(θ)
    double slide_time() const;
    double roll_time() const;

    /// At these instants [s], ascending, none negative. InvalidInput for numbers that make no sense.
    Departure slide(const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;
    Departure roll(const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;
    Departure stick_slip(double mu, const std::vector<double>& instants,
                         const OdeTolerance& tolerance = {}) const;
};

}  // namespace hilda::reference
