// SPDX-License-Identifier: GPL-3.0-or-later
/// Arithmetic of functions of time with their first two derivatives: sum, product, quotient and chain rule.

#pragma once

#include "io/arithmetic/elementary.hpp"

namespace hilda::io {

/// A function of time at one instant: f, df/dt, d²f/dt².
struct Jet {
    double f, fdot, fddot;
};

inline Jet operator+(const Jet& a, const Jet& b) { return {a.f + b.f, a.fdot + b.fdot, a.fddot + b.fddot}; }
inline Jet operator-(const Jet& a, const Jet& b) { return {a.f - b.f, a.fdot - b.fdot, a.fddot - b.fddot}; }
inline Jet operator-(const Jet& a) { return {-a.f, -a.fdot, -a.fddot}; }

inline Jet operator*(const Jet& a, const Jet& b)
{
    return {a.f * b.f, a.fdot * b.f + a.f * b.fdot, a.fddot * b.f + 2 * a.fdot * b.fdot + a.f * b.fddot};
}

inline Jet operator/(const Jet& a, const Jet& b)
{
    // from q b = a, differentiated twice
    const double q = a.f / b.f;
    const double qdot = (a.fdot - q * b.fdot) / b.f;
    return {q, qdot, (a.fddot - 2 * qdot * b.fdot - q * b.fddot) / b.f};
}

/// g(x(t)) and its time derivatives from g, g' and g'' at x
inline Jet chain(const Jet& x, double g, double g1, double g2)
{
    return {g, g1 * x.fdot, g2 * x.fdot * x.fdot + g1 * x.fddot};
}

/// The first of x, ẋ and ẍ that is not zero. It has the sign of x immediately after t.
inline double leading_coefficient(const Jet& x) { return x.f != 0 ? x.f : x.fdot != 0 ? x.fdot : x.fddot; }

inline Jet abs(const Jet& x)
{
    const double sign = leading_coefficient(x) < 0 ? -1 : 1;
    return {std::abs(x.f), sign * x.fdot, sign * x.fddot};
}

/// Unit step: 0 for x < 0, else 1. NaN for NaN.
inline double step(double x) { return std::isnan(x) ? x : x < 0 ? 0 : 1; }
inline Jet step(const Jet& x) { return {step(x.f), 0, 0}; }

/// a for c > 0, else b. NaN for c = NaN. The derivatives are those of the branch that is valid immediately
/// after t.
inline double select(double c, double a, double b) { return std::isnan(c) ? c : c > 0 ? a : b; }
inline Jet select(const Jet& c, const Jet& a, const Jet& b)
{
    if (std::isnan(c.f)) return {c.f, c.f, c.f};
    const Jet& next = leading_coefficient(c) > 0 ? a : b;
    return {select(c.f, a.f, b.f), next.fdot, next.fddot};
}

}  // namespace hilda::io
