// SPDX-License-Identifier: GPL-3.0-or-later
/// Angular momentum at the nodes of steps that turn a body by A_{n+1} = A_n exp(h ω̄).

#pragma once

#include "lie/check.hpp"
#include "lie/so3.hpp"

#include <limits>

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// What of a momentum J̄ ω̄, constant on a step that turns by θ̄ = h ω̄, stands at its first node (θ̄ as it is) or at
/// its last one (-θ̄), body frame of that node:
///
///     (I + θ̃/2 + c θ̃θ̃) J̄ ω̄,   c = (1 - (θ/2) cot(θ/2))/θ²
///
/// The two are equal in global axes: A_n of the one is A_{n+1} of the other. A step in which each node passes on what
/// it has received, and the impulsive moments on top, keeps the angular momentum exactly, and is of second order.
inline Vec3 node_momentum(const Vec3& theta_bar, const Vec3& J_omega)
{
    const double theta = theta_bar.norm(), squared = theta * theta;
    const double c = theta < 0.1 ? 1. / 12 + squared * (1. / 720 + squared * (1. / 30240 + squared / 1209600))
                                 : (1 - 0.5 * theta / std::tan(0.5 * theta)) / squared;
    const Vec3 once = theta_bar.cross(J_omega);
    return J_omega + 0.5 * once + c * theta_bar.cross(once);
}

/// The ω̄ of a step h that has this momentum at its first node, from a guess: iterated with J̄ alone, which gains the
/// factor h|ω̄| each time. lie::NumericalFailure "newton_diverged" where the body turns by a radian or so in a step.
inline Vec3 half_step_omega(const Mat3& J_bar, const Mat3& J_bar_inverse, const Vec3& momentum, double h,
                            Vec3 omega_bar)
{
    constexpr int most = 100;
    constexpr double rounding = 1e-15;
    double before = std::numeric_limits<double>::infinity();
    for (int k = 0; k < most; ++k) {
        const Vec3 correction = J_bar_inverse * (momentum - node_momentum(h * omega_bar, J_bar * omega_bar));
        omega_bar += correction;
        const double size = correction.norm();
        if (size <= rounding * omega_bar.norm()) return omega_bar;
        if (size >= before && size <= 1e2 * rounding * omega_bar.norm())
            return omega_bar;  // as far as rounding lets
        before = size;
    }
    throw lie::NumericalFailure(
        "newton_diverged", "contact::DviScene: a body turns too far in one step for its angular momentum");
}

}  // namespace hilda::contact
