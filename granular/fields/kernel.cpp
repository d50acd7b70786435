// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/fields/kernel.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

const double inside = std::erf(Kernel::cut / std::numbers::sqrt2);  // of a Gaussian, up to the cut

/// Below this length, in widths, the mean on a line is the value at its middle. The error is of the square.
constexpr double short_line = 1e-6;

/// Antiderivatives in u of powers of ρ = √(d² + u²)
struct Powers {
    double second, third, fourth;

    Powers(double d, double u)
    {
        const double rho = std::sqrt(d * d + u * u), d2 = d * d, u2 = u * u;
        second = u * (d2 + u2 / 3);
        third = u * (2 * u2 + 5 * d2) * rho / 8 + (d > 0 ? 0.375 * d2 * d2 * std::asinh(u / d) : 0);
        fourth = u * (d2 * d2 + 2 * d2 * u2 / 3 + u2 * u2 / 5);
    }
};

}  // namespace

double Kernel::value(const Vec3& x) const
{
    const double w3 = width * width * width, q2 = x.dot(x) / (width * width), pi = std::numbers::pi;
    if (type == Type::lucy) return 105 / (16 * pi * w3) * lucy(q2);
    if (std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) > reach()) return 0;
    const double root = std::sqrt(2 * pi) * inside;
    return std::exp(-q2 / 2) / (root * root * root * w3);
}

double Kernel::integral(double x) const
{
    return 0.5 + 0.5 * std::clamp(std::erf(x / (width * std::numbers::sqrt2)) / inside, -1., 1.);
}

double Kernel::line(const Vec3& x, const Vec3& a) const
{
    if (a.norm() < short_line * width) return value(x + 0.5 * a);
    return type == Type::gaussian ? gaussian_line(x, a) : lucy_line(x, a);
}

/// With u the distance along the line from the point closest to 0, and d that of this point from 0:
///
///     ∫ exp(-(d² + u²)/(2 w²)) du = exp(-d²/(2 w²)) w √(π/2) erf(u/(w √2))
double Kernel::gaussian_line(const Vec3& x, const Vec3& a) const
{
    double first = 0, last = 1;
    for (const auto& [at, along] : {std::pair{x.x, a.x}, {x.y, a.y}, {x.z, a.z}}) {
        if (along == 0 && std::abs(at) > reach()) return 0;
        if (along == 0) continue;
        const double one = (-reach() - at) / along, other = (reach() - at) / along;
        first = std::max(first, std::min(one, other)), last = std::min(last, std::max(one, other));
    }
    if (first >= last) return 0;
    const double length = a.norm(), u = x.dot(a) / length, scale = width * std::numbers::sqrt2;
    const Vec3 closest = x - (u / length) * a;
    const double peak = value({0, 0, 0}) * std::exp(-closest.dot(closest) / (scale * scale));
    const double difference = std::erf((u + last * length) / scale) - std::erf((u + first * length) / scale);
    return peak * width * std::sqrt(std::numbers::pi / 2) * difference / length;
}

double Kernel::lucy_line(const Vec3& x, const Vec3& a) const
{
    const double length = a.norm(), along = x.dot(a) / length;
    const double d = (x - (along / length) * a).norm() / width;
    if (d >= 1) return 0;
    const double end = std::sqrt(1 - d * d), first = std::max(along / width, -end),
                 last = std::min((along + length) / width, end);
    if (first >= last) return 0;
    const auto integral = [d](double u) {
        const Powers of(d, u);
        return u - 6 * of.second + 8 * of.third - 3 * of.fourth;
    };
    return value({0, 0, 0}) * (integral(last) - integral(first)) * width / length;
}

}  // namespace hilda::granular
