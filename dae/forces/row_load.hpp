// SPDX-License-Identifier: GPL-3.0-or-later
/// The derivatives of a scalar force or torque that acts along a row on two bodies.
#pragma once

#include "dae/force.hpp"

namespace hilda::dae {

using Vec12 = Eigen::Matrix<double, 12, 1>;

/// The loads -f w on bodies i and j, w = (r_i, pi_i, r_j, pi_j), where f = f(q, q̇, t) with q̇ = w · v:
///
///     δ(load) = -w (∂f/∂q g + ∂f/∂q̇ vᵀ W) δ(r, θ̄) - f W δ(r, θ̄) - ∂f/∂q̇ w wᵀ δv
///
/// g = ∂q/∂(δr, δθ̄) and W = ∂w/∂(δr, δθ̄). g is w where w is a gradient.
struct RowLoad {
    Vec12 w = Vec12::Zero(), g = Vec12::Zero();
    Eigen::Matrix<double, 12, 12> W = Eigen::Matrix<double, 12, 12>::Zero();

    /// Adds the derivatives for f and its derivatives by q and q̇. v = (ṙ, ω̄) of bodies i and j.
    void add_to(double f, double by_q, double by_qdot, const Vec12& v, Force::LoadDerivatives& out) const;
};

/// v of bodies i and j
Vec12 velocities(const Motion& bi, const Motion& bj);

/// q is the distance of the points s_bar_i of body i and s_bar_j of body j, which must not be zero [m]:
/// w = g, and W is its second derivative.
RowLoad distance_row(const Motion& bi, const Vec3& s_bar_i, const Motion& bj, const Vec3& s_bar_j);

}  // namespace hilda::dae
