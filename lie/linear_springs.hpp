// SPDX-License-Identifier: GPL-3.0-or-later
/// Stability limit of explicit steps for linear springs and dampers.

#pragma once

#include <Eigen/Core>

namespace hilda::lie {

/// Springs and dampers in n relative motions q̇ = C v of bodies, with the forces -K q - D q̇. C has the rows
/// of the motions, and v = (ṙ, ω̄).
///
/// A scheme that evaluates these forces explicitly is stable with a step h if the eigenvalues of W P are
/// below 4:
///
///     W = C M⁻¹ Cᵀ,     P = 2 d h D + h² K
///
/// The factor d is lie::damping_factor(): 1 for symplectic Euler, whose loads contain the velocities of the
/// last half step, and 2 for leapfrog with extrapolated velocities. At the limit an eigenvalue of the step is
/// -1. For one motion with frequency ω and damping ratio ζ, h ω = 2 (√(1 + d² ζ²) - d ζ).
///
/// n may be Eigen::Dynamic. The functions are compiled for n = 6 and Eigen::Dynamic.
template <int n>
struct LinearSprings {
    using Matrix = Eigen::Matrix<double, n, n>;
    using Vector = Eigen::Matrix<double, n, 1>;
    Matrix W;  ///< inverse effective masses [1/kg, 1/(kg m) or 1/(kg m²)]; symmetric, positive semidefinite
    Vector K;  ///< stiffness [N/m or N m/rad]
    Vector D;  ///< damping [N s/m or N m s/rad]

    /// Whether a step h [s] is below the limit. For a negative stiffness an element of P decreases beyond
    /// h = -d D/K. Its largest value up to h is used, so that all steps above the limit are unstable.
    /// Negative elements count as zero. Does not allocate memory for a fixed n.
    bool is_stable(double h, double damping_factor) const;
    /// The limit [s], by bisection to a relative error of 1e-12. Infinite if a step of 1e6 s is stable. Not
    /// below 1e-15 s.
    double stable_step(double damping_factor) const;
};

extern template struct LinearSprings<6>;
extern template struct LinearSprings<Eigen::Dynamic>;

}  // namespace hilda::lie
