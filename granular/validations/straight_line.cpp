// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/straight_line.hpp"

#include <cmath>

namespace hilda::granular {

StraightLine::StraightLine(const std::vector<double>& x, const std::vector<double>& y)
{
    const auto n = static_cast<double>(x.size());
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
    for (std::size_t k = 0; k < x.size(); ++k) mean_x += x[k] / n, mean_y += y[k] / n;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double u = x[k] - mean_x, v = y[k] - mean_y;
        xx += u * u, xy += u * v, yy += v * v;
    }
    b = xy / xx, a = mean_y - b * mean_x, r2 = xy * xy / (xx * yy);
}

double exponent(const std::vector<double>& x, const std::vector<double>& y)
{
    std::vector<double> log_x, log_y;
    for (const double one : x) log_x.push_back(std::log(one));
    for (const double one : y) log_y.push_back(std::log(one));
    return StraightLine(log_x, log_y).b;
}

}  // namespace hilda::granular
