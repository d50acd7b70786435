// SPDX-License-Identifier: GPL-3.0-or-later
/// Location of the zero of a scalar function between two values of different sign.

#pragma once

#include "lie/check.hpp"

#include <cmath>

namespace hilda::lie {

/// A bracket [a, b] of a zero of g, narrowed by regula falsi with the Illinois modification: the value at an
/// end that remains twice is halved, so that both ends converge.    Dowell, Jarratt (1971), BIT 11, 168-174
///
/// If three evaluations have not halved the bracket, the next one is at its middle, as it is for functions
/// that are flat, steep or discontinuous at the zero: the width is at most 2^-n of the first one after 4 n
/// evaluations.
class Bracket {
public:
    /// g(a) and g(b) have different signs; g(b) may be zero.
    Bracket(double a, double g_a, double b, double g_b) : a(a), b(b), g_a(g_a), g_b(g_b), width(b - a) {}

    double a, b;

    /// The next place for an evaluation of g: that of the secant, at least `least` from both ends, or the
    /// middle if this is not inside (a, b)
    double next(double least = 0) const
    {
        const double s = std::fmin(std::fmax(b - g_b * (b - a) / (g_b - g_a), a + least), b - least);
        return s > a && s < b && !is_slow ? s : a + 0.5 * (b - a);
    }

    /// Replaces the end with the sign of g(s) by s; b if g(s) is zero. Returns whether it is b.
    bool add(double s, double g)
    {
        const bool is_b = g == 0 || (g > 0) != (g_a > 0);
        double &end = is_b ? b : a, &g_end = is_b ? g_b : g_a, &g_other = is_b ? g_a : g_b;
        end = s, g_end = g;
        if (last == (is_b ? 1 : -1)) g_other /= 2;
        last = is_b ? 1 : -1;
        is_slow = ++evaluations == 3 && b - a > 0.5 * width;
        if (evaluations == 3 || b - a <= 0.5 * width) evaluations = 0, width = b - a;
        return is_b;
    }

private:
    double g_a, g_b;
    double width;  ///< before the last `evaluations`
    int evaluations = 0;
    bool is_slow = false;
    int last = 0;  ///< the end that was replaced last: 1 is b, -1 is a, 0 none
};

/// Narrows a bracket to the width `tolerance`, or to neighbouring numbers, or until g(b) is zero. Throws
/// NumericalFailure "event_not_finite" if g is not a number.
template <class G>
void narrow(Bracket& bracket, double tolerance, const G& g)
{
    while (bracket.b - bracket.a > tolerance) {
        const double s = bracket.next(0.5 * tolerance);
        if (!(s > bracket.a && s < bracket.b)) return;
        const double g_s = g(s);
        if (std::isnan(g_s))
            throw NumericalFailure("event_not_finite",
                                   "a function whose zero is to be located is not a number");
        if (bracket.add(s, g_s) && g_s == 0) return;
    }
}

}  // namespace hilda::lie
