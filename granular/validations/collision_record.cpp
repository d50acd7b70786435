// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/collision_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::granular {

namespace {

/// One pass of the filter over x, which starts in the stationary state of the first value
void pass(std::vector<double>& x, double cut_off, double rate)
{
    const double K = std::tan(std::numbers::pi * cut_off / rate),
                 scale = 1 / (1 + std::numbers::sqrt2 * K + K * K);
    const double b = K * K * scale, a_1 = 2 * (K * K - 1) * scale,
                 a_2 = (1 - std::numbers::sqrt2 * K + K * K) * scale;
    double x_1 = x.front(), x_2 = x_1, y_1 = x_1, y_2 = x_1;
    for (double& value : x) {
        const double y = b * (value + 2 * x_1 + x_2) - a_1 * y_1 - a_2 * y_2;
        x_2 = x_1, x_1 = value, y_2 = y_1, y_1 = y;
        value = y;
    }
}

}  // namespace

std::vector<double> low_pass(const std::vector<double>& x, double cut_off, double rate)
{
    if (x.empty()) return x;
    const std::size_t n = x.size(),
                      more = std::min(n - 1, static_cast<std::size_t>(std::ceil(3 * rate / cut_off)));
    std::vector<double> y(n + 2 * more);
    for (std::size_t k = 0; k < more; ++k)
        y[k] = 2 * x.front() - x[more - k], y[n + more + k] = 2 * x.back() - x[n - 2 - k];
    std::copy(x.begin(), x.end(), y.begin() + static_cast<std::ptrdiff_t>(more));
    for (int direction = 0; direction < 2; ++direction) {
        pass(y, cut_off, rate);
        std::reverse(y.begin(), y.end());
    }
    const auto first = y.begin() + static_cast<std::ptrdiff_t>(more);
    return {first, first + static_cast<std::ptrdiff_t>(n)};
}

Collision collision(const CollisionRecord& r)
{
    Collision c;
    const std::size_t n = r.z.size(), last = n - 1;
    // A contact adds to -g. The tolerance is far above the rounding error of the free fall.
    const double tolerance = 1e-4 * r.g;
    while (c.start < last && r.a[c.start + 1] < tolerance - r.g) ++c.start;
    const auto peak =
        static_cast<std::size_t>(std::max_element(r.a_low.begin(), r.a_low.end()) - r.a_low.begin());
    std::size_t slow = std::max(peak, c.start);
    while (slow < last && std::abs(r.v[slow]) >= slow_speed) ++slow;
    c.slowed = std::abs(r.v[slow]) < slow_speed;
    c.end = c.start + static_cast<std::size_t>(std::ceil(0.9 * static_cast<double>(slow - c.start)));
    while (c.end < last && r.a_low[c.end] >= 0.1 * r.g) ++c.end;
    c.speed = -r.v[c.start], c.depth = r.z[c.start] - r.z[c.end];
    c.time = static_cast<double>(c.end - c.start) * r.interval;
    c.peak = r.a_low[peak];
    return c;
}

}  // namespace hilda::granular
