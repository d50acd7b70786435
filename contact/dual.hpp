// SPDX-License-Identifier: GPL-3.0-or-later
/// Forward automatic differentiation of second order for functions of three variables (hyper-dual
/// arithmetic).

#pragma once

#include "io/arithmetic/elementary.hpp"

#include <Eigen/Core>

#include <cmath>

namespace hilda::contact {

/// Value and derivatives of a function of (x, y, z) at one point: f, ∇f, and the upper triangle of ∇²f in the
/// order xx, xy, xz, yy, yz, zz. The operators apply the product, quotient and chain rules.
struct Dual {
    using Gradient = Eigen::Vector3d;
    using UpperTriangle = Eigen::Matrix<double, 6, 1>;

    double f = 0;
    Gradient g = Gradient::Zero();
    UpperTriangle h = UpperTriangle::Zero();

    Dual() = default;
    Dual(double f) : f(f) {}  // NOLINT: implicit, a number is a constant function
    Dual(double f, const Gradient& g, const UpperTriangle& h) : f(f), g(g), h(h) {}

    /// The coordinate k = 0, 1, 2 at the value x: ∂/∂x_k = 1
    static Dual variable(double x, int k) { return {x, Gradient::Unit(k), UpperTriangle::Zero()}; }

    Eigen::Matrix3d hessian() const
    {
        Eigen::Matrix3d H;
        H << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5];
        return H;
    }

    Dual& operator+=(const Dual& b) { return f += b.f, g += b.g, h += b.h, *this; }
    Dual& operator-=(const Dual& b) { return f -= b.f, g -= b.g, h -= b.h, *this; }
    Dual& operator*=(const Dual& b) { return *this = *this * b; }
    Dual& operator/=(const Dual& b) { return *this = *this / b; }

    friend Dual operator+(Dual a, const Dual& b) { return a += b; }
    friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
    friend Dual operator+(const Dual& a) { return a; }
    friend Dual operator-(const Dual& a) { return {-a.f, -a.g, -a.h}; }

    friend Dual operator*(const Dual& a, const Dual& b)
    {
        return {a.f * b.f, a.f * b.g + b.f * a.g, a.f * b.h + b.f * a.h + symmetric_product(a.g, b.g)};
    }
    friend Dual operator*(double a, const Dual& b) { return {a * b.f, a * b.g, a * b.h}; }
    friend Dual operator*(const Dual& a, double b) { return b * a; }

    friend Dual operator/(const Dual& a, const Dual& b)
    {
        // from q b = a: q' = (a' - q b')/b, q'' = (a'' - q b'' - q' b' - b' q')/b
        const double q = a.f / b.f;
        const Gradient dq = (a.g - q * b.g) / b.f;
        return {q, dq, (a.h - q * b.h - symmetric_product(dq, b.g)) / b.f};
    }
    friend Dual operator/(const Dual& a, double b) { return {a.f / b, a.g / b, a.h / b}; }

    // comparisons use the value only, so that formulas may have branches
    friend bool operator<(const Dual& a, const Dual& b) { return a.f < b.f; }
    friend bool operator>(const Dual& a, const Dual& b) { return a.f > b.f; }
    friend bool operator<=(const Dual& a, const Dual& b) { return a.f <= b.f; }
    friend bool operator>=(const Dual& a, const Dual& b) { return a.f >= b.f; }

    /// Upper triangle of a bᵀ + b aᵀ
    static UpperTriangle symmetric_product(const Gradient& a, const Gradient& b)
    {
        UpperTriangle ab;
        ab << 2 * a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0], 2 * a[1] * b[1],
            a[1] * b[2] + a[2] * b[1], 2 * a[2] * b[2];
        return ab;
    }
};

/// Chain rule: the function u of x, from u, u' and u'' at the value of x.
inline Dual chain(const Dual& x, double u, double u1, double u2)
{
    return {u, u1 * x.g, u1 * x.h + 0.5 * u2 * Dual::symmetric_product(x.g, x.g)};
}

using io::acos, io::asin, io::atan, io::cos, io::cosh, io::exp, io::log, io::pow, io::sin, io::sinh;
using io::sqrt, io::tan, io::tanh;

/// Polar angle of the point (x, y) [rad]. Not defined for x = y = 0.
inline Dual atan2(const Dual& y, const Dual& x)
{
    // atan(y/x) and -atan(x/y) have the same derivatives; the divisor is the larger of x and y
    Dual angle = std::abs(x.f) >= std::abs(y.f) ? atan(y / x) : -atan(x / y);
    angle.f = std::atan2(y.f, x.f);
    return angle;
}

/// |x|. At x = 0 the derivatives are the right-hand derivatives.
inline Dual abs(const Dual& x) { return x.f < 0 ? -x : x; }

}  // namespace hilda::contact
