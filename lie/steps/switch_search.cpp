// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/switch_search.hpp"

#include "lie/bracket.hpp"
#include "lie/steps/cubic_path.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::lie {

namespace {

bool signs_differ(double a, double b) { return (a > 0 && b < 0) || (a < 0 && b > 0); }

}  // namespace

SwitchSearch::SwitchSearch(const System& system)
    : system(system), count(static_cast<std::size_t>(system.switches()))
{
    for (std::vector<double>& values : at) values.resize(count);
    g.resize(count);
}

void SwitchSearch::set_values(const State& x_at, std::vector<double>& values) const
{
    system.switching(x_at, values.data());
}

bool SwitchSearch::differ(const State& a, const State& b)
{
    set_values(a, at[0]), set_values(b, at[1]);
    for (std::size_t k = 0; k < count; ++k)
        if (signs_differ(at[0][k], at[1][k])) return true;
    return false;
}

double SwitchSearch::value(std::size_t k, double s, const Path& path)
{
    path(s, x);
    set_values(x, g);
    return g[k];
}

SwitchSearch::Crossing SwitchSearch::first(const State& from, const State& to, double from_place)
{
    return first(
        to, [&](double s, State& between) { set_between(from, to, s, between); }, from_place);
}

SwitchSearch::Crossing SwitchSearch::first(const State& to, const Path& path, double from_place)
{
    begin = std::min(from_place, 0.5 / parts);
    x = to;
    set_values(to, at[parts]);
    for (int n = 0; n < parts; ++n) {
        path(place(n), x);
        set_values(x, at[n]);
    }
    Crossing crossing;
    for (std::size_t k = 0; k < count; ++k) search(k, path, crossing);
    return crossing;
}

/// Replaces the crossing by that of function k if it is earlier.
void SwitchSearch::search(std::size_t k, const Path& path, Crossing& crossing)
{
    double g_before = at[0][k];  // the last value that is not zero
    for (int n = 0; n < parts; ++n) {
        const double s = place(n), s_next = place(n + 1);
        if (s >= crossing.s) return;
        const double now = at[n][k], next = at[n + 1][k];
        if (now != 0) g_before = now;
        if (signs_differ(g_before, next))
            return bracket(k, path, s, now == 0 ? g_before : now, s_next, next, crossing);
        if (may_have_minimum(k, path, n) && search_minimum(k, path, n, crossing)) return;
    }
}

/// Whether |g| may have a minimum, at which g may change its sign, between the places n and n + 1: both
/// slopes of |g| point into the interval.
bool SwitchSearch::may_have_minimum(std::size_t k, const Path& path, int n)
{
    const double now = std::abs(at[n][k]), next = std::abs(at[n + 1][k]);
    if (!(std::isfinite(now) && std::isfinite(next)) || (now == 0 && next == 0)) return false;
    const auto falls_from = [&](int n_at, double size, int towards) {
        // With the neighbour on the other side. At the ends of the step there is none.
        if (n_at > 0 && n_at < parts) return std::abs(at[n_at - towards][k]) >= size;
        constexpr double near = 1e-6;
        return std::abs(value(k, place(n_at) + towards * near, path)) < size;
    };
    return falls_from(n, now, 1) && falls_from(n + 1, next, -1);
}

/// Looks for the minimum of |g| between the places n and n + 1 by golden sections. Whether g changes its
/// sign.
bool SwitchSearch::search_minimum(std::size_t k, const Path& path, int n, Crossing& crossing)
{
    constexpr double golden = 0.3819660112501051, narrow_enough = 1e-10;
    const double start = place(n), g_begin = at[n][k] != 0 ? at[n][k] : at[n + 1][k];
    double a = start, b = place(n + 1), left = a + golden * (b - a), right = b - golden * (b - a);
    double g_left = value(k, left, path), g_right = value(k, right, path);
    while (b - a > narrow_enough) {
        const bool is_left = std::abs(g_left) < std::abs(g_right);
        const double s = is_left ? left : right, g_s = is_left ? g_left : g_right;
        if (signs_differ(g_begin, g_s)) {
            bracket(k, path, start, g_begin, s, g_s, crossing);
            return true;
        }
        if (is_left) {
            b = right, right = left, g_right = g_left;
            left = a + golden * (b - a), g_left = value(k, left, path);
        } else {
            a = left, left = right, g_left = g_right;
            right = b - golden * (b - a), g_right = value(k, right, path);
        }
    }
    return false;
}

/// Locates the change of the sign of g between a and b.
void SwitchSearch::bracket(std::size_t k, const Path& path, double a, double g_a, double b, double g_b,
                           Crossing& crossing)
{
    constexpr double tolerance = 1e-14;
    Bracket bracket(a, g_a, b, g_b);
    narrow(bracket, tolerance, [&](double s) { return value(k, s, path); });
    // The end a stays behind where a trial has met the zero.
    const double s = std::max(bracket.a, bracket.b - 2 * tolerance);
    if (s < crossing.s) crossing = {s, bracket.b};
}

}  // namespace hilda::lie
