// SPDX-License-Identifier: GPL-3.0-or-later
/// Interval arithmetic: bounds of a function of time over an interval of time, and of its first derivative.
///
/// Moore, Kearfott, Cloud (2009), Introduction to Interval Analysis, Chs. 2, 5, 6. The bounds of each
/// operation are widened by a rounding error.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::io {

/// The numbers from lo to hi. All numbers where nothing is known.
struct Range {
    double lo = -std::numeric_limits<double>::infinity(), hi = std::numeric_limits<double>::infinity();

    static Range point(double x) { return {x, x}; }
    /// [lo, hi] widened by rounding; all numbers if a bound is NaN
    static Range around(double lo, double hi)
    {
        constexpr double eps = 2 * std::numeric_limits<double>::epsilon();
        if (std::isnan(lo) || std::isnan(hi)) return {};
        return {std::isfinite(lo) ? lo - eps * std::abs(lo) : lo,
                std::isfinite(hi) ? hi + eps * std::abs(hi) : hi};
    }
    bool contains(double x) const { return lo <= x && x <= hi; }
    bool contains(const Range& r) const { return lo <= r.lo && r.hi <= hi; }
    double width() const { return hi - lo; }
};

inline Range hull(const Range& a, const Range& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }

inline Range operator+(const Range& a, const Range& b) { return Range::around(a.lo + b.lo, a.hi + b.hi); }
inline Range operator-(const Range& a, const Range& b) { return Range::around(a.lo - b.hi, a.hi - b.lo); }
inline Range operator-(const Range& a) { return {-a.hi, -a.lo}; }

inline Range operator*(const Range& a, const Range& b)
{
    const auto product = [](double x, double y) { return x == 0 || y == 0 ? 0 : x * y; };
    const double p[] = {product(a.lo, b.lo), product(a.lo, b.hi), product(a.hi, b.lo), product(a.hi, b.hi)};
    return Range::around(*std::min_element(p, p + 4), *std::max_element(p, p + 4));
}

inline Range operator/(const Range& a, const Range& b)
{
    if (b.contains(0)) return {};
    return a * Range::around(1 / b.hi, 1 / b.lo);
}

/// A function of time over an interval: bounds of f and of df/dt. All numbers for df/dt where f jumps.
struct RangeJet {
    Range f, fdot;
};

inline RangeJet operator+(const RangeJet& a, const RangeJet& b) { return {a.f + b.f, a.fdot + b.fdot}; }
inline RangeJet operator-(const RangeJet& a, const RangeJet& b) { return {a.f - b.f, a.fdot - b.fdot}; }
inline RangeJet operator-(const RangeJet& a) { return {-a.f, -a.fdot}; }
inline RangeJet operator*(const RangeJet& a, const RangeJet& b)
{
    return {a.f * b.f, a.fdot * b.f + a.f * b.fdot};
}
inline RangeJet operator/(const RangeJet& a, const RangeJet& b)
{
    const Range q = a.f / b.f;
    return {q, (a.fdot - q * b.fdot) / b.f};
}

/// g(x) for a function g that increases, with g' in `slope`
template <class G>
RangeJet increasing(const RangeJet& x, G g, const Range& slope)
{
    return {Range::around(g(x.f.lo), g(x.f.hi)), slope * x.fdot};
}

/// Bounds of a function with its maxima 1 at phase + 2 pi k, its minima -1 between them, and monotone
/// otherwise
template <class G>
Range of_wave(const Range& x, double phase, G g)
{
    constexpr double turn = 2 * std::numbers::pi;
    const auto holds = [&](double place) {
        const double next = place + turn * std::ceil((x.lo - place) / turn);
        return next <= x.hi + 1e-14 * std::abs(x.hi);
    };
    if (!(x.width() < turn) || !(std::abs(x.lo) < 1e15)) return {-1, 1};
    const double a = g(x.lo), b = g(x.hi);
    Range r = Range::around(std::min(a, b), std::max(a, b));
    if (holds(phase)) r.hi = 1;
    if (holds(phase - std::numbers::pi)) r.lo = -1;
    return r;
}
inline Range sin(const Range& x)
{
    return of_wave(x, std::numbers::pi / 2, [](double t) { return std::sin(t); });
}
inline Range cos(const Range& x)
{
    return of_wave(x, 0, [](double t) { return std::cos(t); });
}

inline RangeJet sin(const RangeJet& x) { return {sin(x.f), cos(x.f) * x.fdot}; }
inline RangeJet cos(const RangeJet& x) { return {cos(x.f), -sin(x.f) * x.fdot}; }
inline RangeJet tan(const RangeJet& x) { return sin(x) / cos(x); }

inline Range square(const Range& x)
{
    const double a = x.lo * x.lo, b = x.hi * x.hi;
    return Range::around(x.contains(0) ? 0 : std::min(a, b), std::max(a, b));
}
inline RangeJet exp(const RangeJet& x)
{
    const Range g = Range::around(std::exp(x.f.lo), std::exp(x.f.hi));
    return {g, g * x.fdot};
}
inline RangeJet log(const RangeJet& x)
{
    if (!(x.f.lo > 0)) return {};
    return increasing(
        x, [](double y) { return std::log(y); }, Range::point(1) / x.f);
}
inline RangeJet sqrt(const RangeJet& x)
{
    if (!(x.f.lo >= 0)) return {};
    const Range root = Range::around(std::sqrt(x.f.lo), std::sqrt(x.f.hi));
    return {root, Range::point(0.5) / root * x.fdot};
}
inline RangeJet atan(const RangeJet& x)
{
    return increasing(
        x, [](double y) { return std::atan(y); }, Range::point(1) / (Range::point(1) + square(x.f)));
}
inline RangeJet asin(const RangeJet& x)
{
    if (!(x.f.lo >= -1 && x.f.hi <= 1)) return {};
    const Range root = sqrt(RangeJet{Range::point(1) - square(x.f), {}}).f;
    return increasing(
        x, [](double y) { return std::asin(y); }, Range::point(1) / root);
}
inline RangeJet acos(const RangeJet& x)
{
    const RangeJet s = asin(x);
    return {Range::point(std::numbers::pi / 2) - s.f, -s.fdot};
}
inline RangeJet sinh(const RangeJet& x)
{
    const double largest = std::cosh(std::max(std::abs(x.f.lo), std::abs(x.f.hi)));
    return increasing(
        x, [](double y) { return std::sinh(y); }, Range::around(1, largest));
}
inline RangeJet cosh(const RangeJet& x)
{
    const double a = std::cosh(x.f.lo), b = std::cosh(x.f.hi);
    return {Range::around(x.f.contains(0) ? 1 : std::min(a, b), std::max(a, b)),
            Range::around(std::sinh(x.f.lo), std::sinh(x.f.hi)) * x.fdot};
}
inline RangeJet tanh(const RangeJet& x)
{
    const double a = std::tanh(x.f.lo), b = std::tanh(x.f.hi);
    const auto slope = [](double g) { return 1 - g * g; };
    return {Range::around(a, b),
            Range::around(std::min(slope(a), slope(b)), x.f.contains(0) ? 1 : std::max(slope(a), slope(b))) *
                x.fdot};
}
/// x to a constant real power
inline RangeJet pow(const RangeJet& x, double p)
{
    if (!(x.f.lo > 0)) return {};
    const auto of = [&](double exponent) {
        const double a = std::pow(x.f.lo, exponent), b = std::pow(x.f.hi, exponent);
        return Range::around(std::min(a, b), std::max(a, b));
    };
    return {of(p), Range::point(p) * of(p - 1) * x.fdot};
}
/// xⁿ, n >= 0
inline RangeJet natural_power(const RangeJet& x, int n)
{
    const auto of = [&](int exponent) {
        const double a = std::pow(x.f.lo, exponent), b = std::pow(x.f.hi, exponent);
        if (exponent % 2 != 0) return Range::around(a, b);
        return Range::around(x.f.contains(0) && exponent > 0 ? 0 : std::min(a, b), std::max(a, b));
    };
    if (n == 0) return {Range::point(1), Range::point(0)};
    return {of(n), Range::point(n) * of(n - 1) * x.fdot};
}
/// a where c > 0, b where c <= 0
inline RangeJet select(const RangeJet& c, const RangeJet& a, const RangeJet& b)
{
    if (c.f.lo > 0) return a;
    if (c.f.hi <= 0) return b;
    return {hull(a.f, b.f), {}};
}
/// The larger of a and b, or the smaller one, whose derivatives are bounded where they cross
inline RangeJet continuous_select(const RangeJet& c, const RangeJet& a, const RangeJet& b, const Range& f)
{
    return {f, c.f.lo > 0 ? a.fdot : c.f.hi <= 0 ? b.fdot : hull(a.fdot, b.fdot)};
}
inline RangeJet abs(const RangeJet& x)
{
    if (x.f.lo >= 0) return x;
    if (x.f.hi <= 0) return -x;
    return {{0, std::max(-x.f.lo, x.f.hi)}, hull(x.fdot, -x.fdot)};
}
inline RangeJet step(const RangeJet& x)
{
    if (x.f.lo >= 0) return {Range::point(1), Range::point(0)};
    if (x.f.hi < 0) return {Range::point(0), Range::point(0)};
    return {{0, 1}, {}};
}
inline RangeJet min(const RangeJet& a, const RangeJet& b)
{
    return continuous_select(b - a, a, b, {std::min(a.f.lo, b.f.lo), std::min(a.f.hi, b.f.hi)});
}
inline RangeJet max(const RangeJet& a, const RangeJet& b)
{
    return continuous_select(a - b, a, b, {std::max(a.f.lo, b.f.lo), std::max(a.f.hi, b.f.hi)});
}

}  // namespace hilda::io
