// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/normal_arc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::contact {

namespace {

constexpr int most_steps = 100;
constexpr double widest_piece = 2;  // of an arc, for a chord [rad]

}  // namespace

bool NormalArc::find(double known)
{
    const int pieces = end > widest_piece ? 2 : 1;
    double start = -1, s_of_start = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < pieces; ++k) {
        const double phi = largest_on_chord(k * end / pieces, (k + 1) * end / pieces, known);
        if (phi < 0) continue;
        slope(phi);
        if (s() > s_of_start) s_of_start = s(), start = phi;
    }
    return start >= 0 && climb(start);
}

/// ds/dφ. Sets n(φ) and x.
double NormalArc::slope(double phi)
{
    direction = normal(phi);
    x = *body.support(-direction);
    return (x - a).dot(std::cos(phi) * m - std::sin(phi) * n);
}

/// φ of the maximum of g = s(u) over the chord u = (1 - t) u_0 + t u_1 of a piece of the arc. With s(c u) =
/// c s(u) for c > 0 it is a concave function of t, which lies below its tangents. Where s > 0 it has one
/// maximum on the arc: the first φ with s > 0 is then returned. Negative if the maximum is less than `known`.
double NormalArc::largest_on_chord(double first, double last, double known) const
{
    const Vec3 u_0 = normal(first), across = normal(last) - u_0;
    struct Point {
        double t, g, slope;
    };
    const auto at_t = [&](double t) -> Point {
        const Vec3 u = u_0 + t * across, from_a = *body.support(-u.normalized()) - a;
        return {t, u.dot(from_a), across.dot(from_a)};
    };
    const double least = std::min(known, 0.) - length;
    Point low = at_t(0), high = at_t(1);
    if (low.g > 0 || !(low.slope > 0)) return first;
    if (high.g > 0 || !(high.slope < 0)) return last;
    for (int step = 1; step <= most_steps; ++step) {
        const double meet = (high.g - high.slope * (high.t - low.t) - low.g) / (low.slope - high.slope);
        const double bound = low.g + low.slope * meet;
        if (bound < least) return -1;
        const double most = std::max(low.g, high.g);
        if (most > 0 || bound - most <= length || !(meet > 0 && low.t + meet < high.t)) break;
        const Point now = at_t(step % 3 == 0 ? 0.5 * (low.t + high.t) : low.t + meet);
        (now.slope > 0 ? low : high) = now;
    }
    const Vec3 u = u_0 + (low.g > high.g ? low.t : high.t) * across;
    return std::atan2(u.dot(m), u.dot(n));
}

/// Moves to the maximum of s on the arc next to `phi`. Returns false if it is at an end.
bool NormalArc::climb(double phi)
{
    double low = phi, high = phi, at_low = slope(phi), at_high = at_low;
    const double tolerance = 1e-4 * length;
    if (std::abs(at_low) <= tolerance) return true;
    for (double step = 1e-6; at_low > 0 && at_high > 0; step *= 4) {
        if (high == end) return false;
        low = high, at_low = at_high, high = std::min(high + step, end), at_high = slope(high);
    }
    for (double step = 1e-6; at_low < 0 && at_high < 0; step *= 4) {
        if (low == 0) return false;
        high = low, at_high = at_low, low = std::max(low - step, 0.), at_low = slope(low);
    }
    // regula falsi with halved values (Illinois), and bisection in each third step
    int last_side = 0;
    for (int step = 1; step <= most_steps; ++step) {
        const double secant = low + (high - low) * at_low / (at_low - at_high);
        phi = step % 3 == 0 ? 0.5 * (low + high) : std::clamp(secant, low, high);
        const double now = slope(phi);
        if (std::abs(now) <= tolerance || high - low <= std::numeric_limits<double>::epsilon()) break;
        const int side = now > 0 ? 1 : -1;
        (side > 0 ? low : high) = phi;
        (side > 0 ? at_low : at_high) = now;
        if (side == last_side) (side > 0 ? at_high : at_low) *= 0.5;
        last_side = side;
    }
    return true;
}

}  // namespace hilda::contact
