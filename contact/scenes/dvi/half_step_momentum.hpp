// SPDX-License-Identifier: GPL-3.0-or-later
/// Angular momentum at the nodes of steps A_{n+1} = A_n exp(h ω̄) with constant ω̄.

#pragma once

#include "lie/check.hpp"
#include "lie/so3.hpp"

#include <limits>

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// Angular momentum of a step at one of its nodes, in the body frame of that node. The step has J̄ ω̄ and
/// rotates the body by θ̄ = h ω̄. theta_bar is θ̄ for the first node and -θ̄ for the last one.
///
///     (I + θ̃/2 + c θ̃θ̃) J̄ ω̄,   c = (1 - (θ/2) cot(θ/2))/θ²
///
/// In global axes both are the same vector. A step that receives the momentum of its first node from the step
/// before and adds the moments of impulses there conserves angular momentum exactly and is of second order.
/// See docs/theory/schemes/rA-half-1-momentum.md.
inline Vec3 node_momentum(const Vec3& theta_bar, const Vec3& J_omega)
{
    const double theta = theta_bar.norm(), squared = theta * theta;
    const double c = theta < 0.1 ? 1. / 12 + squared * (1. / 720 + squared * (1. / 30240 + squared / 1209600))
                                 : (1 - 0.5 * theta / std::tan(0.5 * theta)) / squared;
    const Vec3 once = theta_bar.cross(J_omega);
    return J_omega + 0.5 * once + c * theta_bar.cross(once);
}

/// ω̄ of a step h from the angular momentum at its first node (body frame). omega_bar is the initial guess.
/// The iteration uses J̄⁻¹ as approximate inverse; it reduces the error by a factor of about h|ω̄| per
/// iteration. Throws lie::NumericalFailure "newton_diverged" if the body rotates by about a radian or more in
/// a step.
inline Vec3 half_step_omega(const Mat3& J_bar, const Mat3& J_bar_inverse, const Vec3& momentum, double h,
                            Vec3 omega_bar)
{
    constexpr int max_iterations = 100;
    constexpr double rounding = 1e-15;
    double before = std::numeric_limits<double>::infinity();
    for (int k = 0; k < max_iterations; ++k) {
        const Vec3 correction = J_bar_inverse * (momentum - node_momentum(h * omega_bar, J_bar * omega_bar));
        omega_bar += correction;
        const double size = correction.norm();
        if (size <= rounding * omega_bar.norm()) return omega_bar;
        if (size >= before && size <= 1e2 * rounding * omega_bar.norm())
            return omega_bar;  // limited by rounding
        before = size;
    }
    throw lie::NumericalFailure(
        "newton_diverged",
        "contact::DviScene: the angular velocity of a body was not found from its angular momentum; "
        "it rotates too far in one step, reduce the step");
}

}  // namespace hilda::contact
