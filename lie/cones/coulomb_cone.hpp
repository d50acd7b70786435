// SPDX-License-Identifier: GPL-3.0-or-later
/// Projection onto the Coulomb cone K_μ = {p ∈ R³: |p_t| ≤ μ p_n}, with p = (p_n, p_t). K_0 is the half line
/// p_n ≥ 0, p_t = 0.

#pragma once

#include "lie/so3.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

/// |x_t|, several times faster than std::hypot, which avoids overflow and underflow
inline double tangential(const Vec3& x) { return std::sqrt(x[1] * x[1] + x[2] * x[2]); }

/// The point of K_μ nearest to x
inline Vec3 project_on_cone(const Vec3& x, double mu)
{
    const double n = x[0], t = tangential(x);
    if (mu * t <= -n) return Vec3::Zero();
    if (t <= mu * n) return x;
    const double s = (n + mu * t) / (1 + mu * mu), by_t = mu * s / t;
    return {s, by_t * x[1], by_t * x[2]};
}

/// A generalised derivative of the projection at x, symmetric, with eigenvalues in [0, 1]
inline Mat3 cone_projection_derivative(const Vec3& x, double mu)
{
    const double n = x[0], t = tangential(x);
    if (mu * t <= -n) return Mat3::Zero();
    if (mu == 0) return Vec3(1, 0, 0).asDiagonal();
    if (t <= mu * n) return Mat3::Identity();
    const double s = (n + mu * t) / (1 + mu * mu);
    const Vec3 direction(0, x[1] / t, x[2] / t), across(0, -direction[2], direction[1]),
        edge = Vec3(1, mu * direction[1], mu * direction[2]) / std::sqrt(1 + mu * mu);
    return edge * edge.transpose() + mu * s / t * (across * across.transpose());
}

}  // namespace hilda::lie
