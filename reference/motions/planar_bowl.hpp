// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball inside an elliptic trough, in the plane x = 0, in one angle: planar case of Fang (2022), Sec. 5.5.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// Tangential spring-damper without a friction bound: F_t = -K_E S - K_D Ṡ, Ṡ the sliding velocity.
///                                                                                  Fang (2022), Sec. 4.3
struct TangentialSpring {
    double K_E = 1e4, K_D = 100;  ///< [N/m], [N s/m]
};

/// Rigid-plastic rolling resistance: the moment 2 η μ F_N/(1/R - κ) opposes rolling, κ is the curvature of
/// the trough at the contact. It is the limit of Fang (2022), Sec. 4.3, for a stiff rolling spring. A rolling
/// ball has μ = μ_k; a ball at rest stays at rest up to the moment with μ = μ_s.
struct RollingResistance {
    double eta = 0.1, mu_s = 0.25, mu_k = 0.2;
};

/// Instant at which a ball with rolling resistance reverses its direction or comes to rest
struct Reversal {
    double t = 0, y = 0;   ///< time [s], y of the contact point [m]
    bool at_rest = false;  ///< true if it remains at rest
};

/// Motion with rolling resistance
struct ResistedRolling {
    std::vector<ContactInstant> instant;
    std::vector<Reversal> reversal;  ///< reversals up to the last instant, in order of time
};

/// The contact point is p = (0, b sin φ, -c cos φ). With D = √(c² sin²φ + b² cos²φ), the tangent t, the
/// inward normal n, the curvature κ, the derivatives by φ and the velocity v of the centre r = p + R n are
///
///     t = (0, b cos φ, c sin φ)/D,    n = (0, -c sin φ, b cos φ)/D,    κ = bc/D³
///     p' = D t,    n' = -κ D t,    t' = κ D n,    v = (1 - Rκ) D φ̇
///
/// With ψ̇ = κ D φ̇, the rotation rate of the tangent, the equations of motion are
///
///     m v̇ = m g·t + F_t,    F_N = m (v ψ̇ - g·n),    J ω̇_x = R F_t + T
///
///     slide     F_t = 0
///     roll      ω_x = -v/R:  (m + J/R²) v̇ = m g·t
///     resist    (m + J/R²) v̇ = m g·t ∓ T/R, T opposes rolling
///     spring    F_t = -K_E S - K_D Ṡ,  Ṡ = v + R ω_x
///
/// φ is not restricted to one revolution. The motion starts at t = 0 with A = 1 and S = 0, rolling without
/// slip; in slide() the ball does not rotate.
struct PlanarBowl {
    double b = 3, c = 2;         ///< semi-axes along y and z [m]
    double R = 0.5, m = 1;       ///< radius and mass of the ball [m, kg]
    double J = 0.4 * m * R * R;  ///< [kg m²]
    double g = 9.81;             ///< [m/s²], along -z

    /// State at t = 0
    struct InitialState {
        double y = 1.5;  ///< y of the contact point, which is on the lower half of the trough [m]
        double v = 0;    ///< velocity of the centre along t [m/s]
    };

    /// Motion at ascending instants [s], none negative. Throws lie::InvalidInput if a length, mass or inertia
    /// is not positive, R is not smaller than the smallest radius of curvature, |y| ≥ b, a coefficient is
    /// negative, μ_s < μ_k, or the instants do not ascend.
    std::vector<ContactInstant> slide(const InitialState& start, const std::vector<double>& instants,
                                      const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> roll(const InitialState& start, const std::vector<double>& instants,
                                     const OdeTolerance& tolerance = {}) const;
    std::vector<ContactInstant> spring(const InitialState& start, const TangentialSpring& law,
                                       const std::vector<double>& instants,
                                       const OdeTolerance& tolerance = {}) const;
    ResistedRolling resist(const InitialState& start, const RollingResistance& law,
                           const std::vector<double>& instants, const OdeTolerance& tolerance = {}) const;

    Vec3 gravity() const { return {0, 0, -g}; }

    /// Period of an oscillation released at rest at y, by quadrature [s]. Throws lie::InvalidInput unless 0 <
    /// |y| < b.
    double slide_period(double y) const;
    double roll_period(double y) const;
};

}  // namespace hilda::reference
