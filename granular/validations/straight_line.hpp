// SPDX-License-Identifier: GPL-3.0-or-later
/// Straight lines through measured points.

#pragma once

#include <vector>

namespace hilda::granular {

/// The line y = a + b x through points by least squares, and its coefficient of determination r². At least
/// two different x.
struct StraightLine {
    double a = 0, b = 0, r2 = 0;

    StraightLine(const std::vector<double>& x, const std::vector<double>& y);
    double at(double x) const { return a + b * x; }
};

/// The exponent b of y = c x^b: the slope of the line through the points (ln x, ln y)
double exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace hilda::granular
