// SPDX-License-Identifier: GPL-3.0-or-later
/// Location of the zero of a scalar function between two values of different sign.

#pragma once

namespace hilda::lie {

/// A bracket [a, b] of a zero of g, narrowed by regula falsi with the Illinois modification: the value at an
/// end that remains twice is halved, so that both ends converge.    Dowell, Jarratt (1971), BIT 11, 168-174
///
///     while (bracket.b - bracket.a > tolerance) bracket.add(s = bracket.next(), g(s));
class Bracket {
public:
    /// g(a) and g(b) have different signs; g(b) may be zero.
    Bracket(double a, double g_a, double b, double g_b) : a(a), b(b), g_a(g_a), g_b(g_b) {}

    double a, b;

    /// The next place for an evaluation of g: that of the secant, or the middle if this is not inside (a, b)
    double next() const
    {
        const double s = b - g_b * (b - a) / (g_b - g_a);
        return s > a && s < b ? s : a + 0.5 * (b - a);
    }

    /// Replaces the end with the sign of g(s) by s; b if g(s) is zero. Returns whether it is b.
    bool add(double s, double g)
    {
        const bool is_b = g == 0 || (g > 0) != (g_a > 0);
        double &end = is_b ? b : a, &g_end = is_b ? g_b : g_a, &g_other = is_b ? g_a : g_b;
        end = s, g_end = g;
        if (last == (is_b ? 1 : -1)) g_other /= 2;
        last = is_b ? 1 : -1;
        return is_b;
    }

private:
    double g_a, g_b;
    int last = 0;  ///< the end that was replaced last: 1 is b, -1 is a, 0 none
};

}  // namespace hilda::lie
