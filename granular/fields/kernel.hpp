// SPDX-License-Identifier: GPL-3.0-or-later
/// Kernels that average particles over space (coarse-graining).

#pragma once

#include "granular/backend/real.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace hilda::granular {

using Vec3 = Vec<double>;

/// A kernel φ(x) with the integral 1, in closed form. It is zero outside of a cube of half edge reach().
///
///     gaussian:  φ = Π g(x_a),  g(x) = exp(-x²/(2 w²))/(w √(2π) erf(3/√2)) for |x| ≤ 3 w
///     lucy:      φ = 105/(16 π w³) (1 - 6 q² + 8 q³ - 3 q⁴),  q = |x|/w ≤ 1                  Lucy (1977)
///
/// w: width [m]. The Gaussian is cut at three standard deviations along each axis.
struct Kernel {
    enum class Type { gaussian, lucy };

    Type type = Type::gaussian;
    double width = 0;  ///< w: standard deviation of the Gaussian, radius of Lucy's kernel [m]

    double reach() const { return type == Type::gaussian ? cut * width : width; }
    double value(const Vec3& x) const;  ///< φ(x) [1/m³]
    /// Its mean on the line from x to x + a [1/m³]:
    ///
    ///     ∫_0^1 φ(x + s a) ds
    double line(const Vec3& x, const Vec3& a) const;
    /// The integral of g from -∞ to x. Of the Gaussian only.
    double integral(double x) const;

    /// 1 - 6 q² + 8 q³ - 3 q⁴ of q², 0 for q ≥ 1
    static double lucy(double q2) { return q2 < 1 ? 1 - 6 * q2 + 8 * q2 * std::sqrt(q2) - 3 * q2 * q2 : 0; }

    static constexpr double cut = 3;  ///< [w]
    static constexpr std::array<const char*, 2> names = {"gaussian", "lucy"};

private:
    double gaussian_line(const Vec3& x, const Vec3& a) const;
    double lucy_line(const Vec3& x, const Vec3& a) const;
};

}  // namespace hilda::granular
