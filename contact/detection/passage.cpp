// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/passage.hpp"

#include "lie/steps/cubic_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::contact {

namespace {

constexpr double shortest_advance = 1e-3;  // relative to the smaller size
constexpr int most_evaluations = 10000;

/// Angle between two orientations: |B - A| = 2 √2 sin(angle/2)
double turn(const Motion& a, const Motion& b)
{
    return 2 * std::asin(std::min(1., (b.A - a.A).norm() / (2 * std::numbers::sqrt2)));
}

/// Bound of the path of the centres relative to each other: the control polygon of the cubic
double path(const Motion& i_begin, const Motion& i_end, const Motion& j_begin, const Motion& j_end, double h)
{
    const Vec3 d = (j_end.r - j_begin.r) - (i_end.r - i_begin.r), v = h / 3 * (j_begin.rdot - i_begin.rdot),
               w = h / 3 * (j_end.rdot - i_end.rdot);
    return v.norm() + (d - v - w).norm() + w.norm();
}

}  // namespace

Passage::Passage(const Motion& i_begin, const Motion& i_end, const Motion& j_begin, const Motion& j_end,
                 double h, double arm_i, double arm_j)
    : i_begin(i_begin), i_end(i_end), j_begin(j_begin), j_end(j_end), h(h),
      bound(path(i_begin, i_end, j_begin, j_end, h) + turn(i_begin, i_end) * arm_i +
            turn(j_begin, j_end) * arm_j)
{}

double Passage::first_overlap(double gap_begin, double size, const Gap& gap) const
{
    if (!(bound > gap_begin)) return 1;
    const double least = shortest_advance * size / bound;
    double s = std::max(gap_begin / bound, least);
    for (int n = 0; n < most_evaluations && s < 1; ++n) {
        const double g = gap(lie::between(i_begin, i_end, h, s), lie::between(j_begin, j_end, h, s));
        if (g < 0) return s;
        s += std::max(g / bound, least);
    }
    return 1;
}

double Passage::deepest(double s, const Gap& gap) const
{
    constexpr int places = 16;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= places; ++k) {
        const double at = s + (1 - s) * k / places;
        least =
            std::min(least, gap(lie::between(i_begin, i_end, h, at), lie::between(j_begin, j_end, h, at)));
    }
    return least;
}

}  // namespace hilda::contact
