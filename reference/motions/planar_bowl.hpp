// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball inside an elliptic trough, in the plane x = 0: the planar case of Fang (2022), Sec. 5.5, in one angle.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// Tangential spring and dashpot that never slips through: F_t = -K_E S - K_D Ṡ, Ṡ the slip velocity.  Sec. 4.3
struct TangentialSpring {
    double K_E = 1e4, K_D = 100;  ///< [N/m], [N s/m]
};

/// Rolling resistance without a spring: a moment 2 η μ F_N/(1/R - κ) against the rolling, κ the curvature of the
/// trough at the contact; the limit of Fang (2022), Sec. 4.3, for a stiff rolling spring. With μ = μ_k it brakes;
/// with μ = μ_s it is the most that holds a ball at rest.
struct RollingResistance {
    double eta = 0.1, mu_s = 0.25, mu_k = 0.2;
};

/// The ball turns round, or stays
struct Turn {
    double t = 0, y = 0;  ///< [s], of the contact point [m]
    bool rest = false;    ///< it stays
};

struct ResistedRoll {
    std::vector<ContactInstant> instant;
    std::vector<Turn> turn;  ///< up to the last instant, in order
};

/// The contact point is p = (0, b sin φ, -c cos φ). With D = √(c² sin²φ + b² cos²φ) the tangent, the normal into
/// the trough, its curvature and what changes along the path of the centre r = p + R n are
///
///     t = (0, b cos φ, c sin φ)/D,    n = (0, -c sin φ, b cos φ)/D,    κ = bc/D³
///     p' = D t,    n' = -κ D t,    t' = κ D n,    v = (1 - Rκ) D φ̇
///
/// and with ψ̇ = κ D φ̇, the rate at which the tangent turns,
///
///     m v̇ = m g·t + F_t,    F_N = m (v ψ̇ - g·n),    J ω̇_x = R F_t + T
///
///     slide     F_t = 0
///     roll      ω_x = -v/R:  (m + J/R²) v̇ = m g·t
///     resist    (m + J/R²) v̇ = m g·t ∓ T/R, T against the rolling
///     spring    F_t = -K_E S - K_D Ṡ,  Ṡ = v + R ω_x
///
/// φ may go round and round. The start is at t = 0 with A = 1 and S = 0, rolling, but for slide(), where the ball
/// does not turn.
struct PlanarBowl {
    double b = 3, c = 2;         ///< semi-axes along y and z [m]
    double R = 0.5, m = 1;       ///< of the ball [m, kg]
    double J = 0.4 * m * R * R;  ///< [kg m²]
    double g = 9.81;             ///< [m/s²], along -z

    struct InitialState {
        double y = 1.5;  ///< of the contact point, below the equator [m]
        double v = 0;    ///< of the centre, along t [m/s]
    };

    /// At these instants [s], ascending, none negative. InvalidInput for a ball that is not smaller than the
    /// smallest radius of curvature, and for numbers that make no sense.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> roll(const InitialState& start, const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> spring(const InitialState& start, const TangentialSpring& law,
                                       const std::vector<double>& instants,
                                       const OdeTolerance& tolerance = {}) const;
    ResistedRoll resist(const InitialState& start, const RollingResistance& law,
                        const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;

    Vec3 gravity() const { return {0, 0, -g}; }

    /// Of a swing from rest, by quadrature [s]
    double slide_period(double y) const;
    double roll_period(double y) const;
};

}  // namespace hilda::reference
