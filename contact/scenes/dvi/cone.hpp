// SPDX-License-Identifier: GPL-3.0-or-later
/// Projection on the Coulomb friction cone.

#pragma once

#include "lie/so3.hpp"

namespace hilda::contact {

using lie::Mat3;
using lie::Vec3;

/// Projection of γ = (γ_n, γ_u, γ_w) on the friction cone, the nearest point of
///
///     K = {γ: |γ_t| ≤ μ γ_n},   γ_t = (γ_u, γ_w)
///
/// A point in the cone is unchanged. A point of the polar cone μ |γ_t| ≤ -γ_n is projected on the apex. Any
/// other point is projected on the lateral surface, along its normal (Anitescu and Tasora 2010). For μ = 0
/// the cone is the half-line γ_n ≥ 0.
inline Vec3 project_on_cone(const Vec3& gamma, double mu)
{
    const double n = gamma[0], t = std::hypot(gamma[1], gamma[2]);
    if (n >= 0 && t <= mu * n) return gamma;  // n >= 0: for μ = 0 and γ_t = 0 the second condition is 0 ≤ -0
    if (mu * t <= -n) return Vec3::Zero();
    const double side = (n + mu * t) / (1 + mu * mu), scale = mu * side / t;
    return t > 0 ? Vec3(side, scale * gamma[1], scale * gamma[2]) : Vec3(side, 0, 0);
}

}  // namespace hilda::contact
