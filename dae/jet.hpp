// SPDX-License-Identifier: GPL-3.0-or-later
/// Arithmetic on a function of time and its first two derivatives: product, quotient and chain rule.

#pragma once

#include "dae/elementary.hpp"

namespace hilda::dae {

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
    // q b = a, differentiated twice
    const double q = a.f / b.f;
    const double qdot = (a.fdot - q * b.fdot) / b.f;
    return {q, qdot, (a.fddot - 2 * qdot * b.fdot - q * b.fddot) / b.f};
}

/// g(x(t)) from g, g' and g'' at x.
inline Jet chain(const Jet& x, double g, double g1, double g2)
{
    return {g, g1 * x.fdot, g2 * x.fdot * x.fdot + g1 * x.fddot};
}

/// A number with the sign that x has just after t.
inline double after(const Jet& x) { return x.f != 0 ? x.f : x.fdot != 0 ? x.fdot : x.fddot; }

inline Jet abs(const Jet& x)
{
    const double sign = after(x) < 0 ? -1 : 1;
    return {std::abs(x.f), sign * x.fdot, sign * x.fddot};
}

/// 0 for x < 0, else 1.
inline double step(double x) { return std::isnan(x) ? x : x < 0 ? 0 : 1; }
inline Jet step(const Jet& x) { return {step(x.f), 0, 0}; }

/// a where c > 0, else b; the derivatives are those of the one that holds just after t.
inline double select(double c, double a, double b) { return std::isnan(c) ? c : c > 0 ? a : b; }
inline Jet select(const Jet& c, const Jet& a, const Jet& b)
{
    if (std::isnan(c.f)) return {c.f, c.f, c.f};
    const Jet& next = after(c) > 0 ? a : b;
    return {select(c.f, a.f, b.f), next.fdot, next.fddot};
}

}  // namespace hilda::dae
