// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/function_of_time.hpp"

#include "dae/curves/sampled_curve.hpp"
#include "io/arithmetic/range.hpp"
#include "lie/check.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hilda::dae {

namespace {

using io::Range;

constexpr double eps = std::numeric_limits<double>::epsilon();
// Subdivisions for one interval. Formulas whose bounds need more are sampled.
constexpr int most_subdivisions = 4000, samples = 64;

/// The intervals of a search that halves them; the first one in time is taken first.
class Halves {
public:
    Halves(double from, double to) { push(from, to); }
    bool empty() const { return count == 0; }
    std::pair<double, double> pop() { return all[--count]; }
    void push_halves(double a, double middle, double b) { push(middle, b), push(a, middle); }
    bool is_full() const { return count + 2 > all.size(); }

private:
    void push(double a, double b) { all[count++] = {a, b}; }

    std::array<std::pair<double, double>, 80> all;
    std::size_t count = 0;
};

double middle(double a, double b) { return a + 0.5 * (b - a); }

/// Bounds of f from those of f and ḟ: natural, and from the value in the middle
Range tightened(const io::Expression& f, double a, double b, const io::RangeJet& natural)
{
    const Range slope = natural.fdot * Range{-0.5 * (b - a), 0.5 * (b - a)};
    const Range centred = Range::point(f.value(middle(a, b))) + slope;
    const Range both{std::max(natural.f.lo, centred.lo), std::min(natural.f.hi, centred.hi)};
    return both.lo <= both.hi ? both : natural.f;
}

bool signs_differ(double a, double b) { return (a < 0 && b > 0) || (a > 0 && b < 0); }

/// Place of the change of a sign, between neighbouring numbers
double bisected(const io::Expression& g, double a, double b)
{
    const double g_a = g.value(a);
    for (;;) {
        const double m = middle(a, b);
        if (!(m > a && m < b)) return b;
        const double g_m = g.value(m);
        if (g_m == 0) return m;
        (signs_differ(g_a, g_m) ? b : a) = m;
    }
}

/// The first zero of g in (from, to]
std::optional<double> first_zero(const io::Expression& g, double from, double to)
{
    Halves left(from, to);
    const double smallest = eps * (to - from);
    for (int n = 0; !left.empty(); ++n) {
        const auto [a, b] = left.pop();
        if (n == most_subdivisions) {
            for (int k = 0; k < samples; ++k) {
                const double s = a + (to - a) * k / samples, next = a + (to - a) * (k + 1) / samples;
                if (signs_differ(g.value(s), g.value(next))) return bisected(g, s, next);
            }
            return std::nullopt;
        }
        const io::RangeJet natural = g.bounds({a, b});
        const Range f = tightened(g, a, b, natural);
        if (f.lo > 0 || f.hi < 0 || (f.lo == 0 && f.hi == 0)) continue;
        const double g_a = g.value(a), g_b = g.value(b);
        const bool is_monotone = natural.fdot.lo > 0 || natural.fdot.hi < 0;
        if (is_monotone && std::isfinite(g_a) && std::isfinite(g_b)) {
            if (g_b == 0) return b;
            if (signs_differ(g_a, g_b)) return bisected(g, a, b);
            continue;
        }
        const double m = middle(a, b);
        if (!(b - a > std::max(smallest, 4 * eps * std::abs(b))) || left.is_full()) {
            if (a > from && ((g_a == 0) != (g_b == 0) || signs_differ(g_a, g_b))) return b;
            continue;
        }
        left.push_halves(a, m, b);
    }
    return std::nullopt;
}

}  // namespace

FunctionOfTime::FunctionOfTime(io::Expression f) : formula(std::move(f))
{
    switching = formula->switching_functions();
    for (int k = -10; k <= 10; ++k)
        if (const double f_k = std::abs(formula->value(std::ldexp(1., k))); std::isfinite(f_k))
            scale = std::max(scale, f_k);
}

FunctionOfTime::FunctionOfTime(std::shared_ptr<const SampledCurve> samples) : curve(std::move(samples))
{
    scale = curve->largest();
}

std::optional<double> FunctionOfTime::first_break(double from, double to) const
{
    std::optional<double> first;
    for (const io::Expression& g : switching)
        if (const std::optional<double> zero = first_zero(g, from, first.value_or(to)); zero) first = zero;
    return first;
}

double FunctionOfTime::value(double t) const { return formula ? formula->value(t) : curve->jet(t).f; }

io::RangeJet FunctionOfTime::bounds(double from, double to) const
{
    const io::RangeJet natural = formula->bounds({from, to});
    return {tightened(*formula, from, to, natural), natural.fdot};
}

double FunctionOfTime::resolved_until(double from, double to) const
{
    constexpr double shortest = 1e-12, reduction = 0.25;
    if (curve && from >= curve->last()) return to;
    if (curve) to = std::min(to, curve->last());
    const double smallest = shortest * (to - from);
    for (double pulse = 0; to - from > smallest && !is_resolved(from, to, pulse);)
        to = std::max(std::min(pulse, to), from + reduction * (to - from));
    return to;
}

/// Whether the function is monotone, or near its chord in each quarter of the interval; otherwise `pulse`
/// is a place before those that are not.
bool FunctionOfTime::is_resolved(double from, double to, double& pulse) const
{
    constexpr int quarters = 4;
    // Of the largest value, of the difference of the largest and the smallest of the five values, and of the
    // values of the formula for the rounding errors of its bounds
    constexpr double negligible = 1e-8, part = 0.25, rounding = 1e-12;
    std::array<Point, quarters + 1> at{};
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (int k = 0; k <= quarters; ++k) {
        const double t = k == quarters ? to : from + (to - from) * k / quarters;
        at[k] = {t, value(t)};
        lo = std::min(lo, at[k].f), hi = std::max(hi, at[k].f);
    }
    if (curve) {
        const double margin = part * (hi - lo) + negligible * scale;
        for (int k = 0; k < quarters; ++k)
            if (!knots_are_near_chord(at[k], at[k + 1], margin, pulse)) return false;
        return true;
    }
    std::array<io::RangeJet, quarters> all{};
    double largest = 0;
    bool rises = true, falls = true;
    for (int k = 0; k < quarters; ++k) {
        all[k] = bounds(at[k].t, at[k + 1].t);
        rises = rises && all[k].fdot.lo >= 0, falls = falls && all[k].fdot.hi <= 0;
        if (std::isfinite(all[k].f.width()))
            largest = std::max({largest, std::abs(all[k].f.lo), std::abs(all[k].f.hi)});
    }
    if (rises || falls) return true;
    const double margin = part * (hi - lo) + negligible * largest + rounding * scale;
    for (int k = 0; k < quarters; ++k) {
        // A function is within (b - a) (max ḟ - min ḟ)/4 of its chord.
        if (0.25 * (at[k + 1].t - at[k].t) * all[k].fdot.width() <= margin) continue;
        if (!is_near_chord(at[k], at[k + 1], margin, pulse)) return false;
    }
    return true;
}

/// Whether the values of a formula differ from the chord between two points by at most a margin; otherwise
/// `outside` is a place before those that do not.
bool FunctionOfTime::is_near_chord(const Point& from, const Point& to, double margin, double& outside) const
{
    constexpr int depth = 12;
    const double leaf = std::ldexp(to.t - from.t, -depth), slope = (to.f - from.f) / (to.t - from.t);
    Halves left(from.t, to.t);
    for (int n = 0; !left.empty() && n < most_subdivisions; ++n) {
        const auto [a, b] = left.pop();
        const Range all = bounds(a, b).f;
        const double at_a = from.f + slope * (a - from.t), at_b = from.f + slope * (b - from.t);
        if (all.hi <= std::min(at_a, at_b) + margin && all.lo >= std::max(at_a, at_b) - margin) continue;
        const double m = middle(a, b);
        if (b - a > leaf && m > a && m < b) {
            left.push_halves(a, m, b);
            continue;
        }
        if (std::abs(value(m) - middle(at_a, at_b)) <= margin && !std::isfinite(all.width())) continue;
        outside = a;
        return false;
    }
    return true;
}

/// The same for a curve, at its knots and in the middle between them
bool FunctionOfTime::knots_are_near_chord(const Point& from, const Point& to, double margin,
                                          double& outside) const
{
    const double slope = (to.f - from.f) / (to.t - from.t);
    for (double a = from.t; a < to.t;) {
        const double b = std::min(curve->next_knot(a), to.t);
        for (const double t : {middle(a, b), b})
            if (!(std::abs(value(t) - (from.f + slope * (t - from.t))) <= margin)) {
                outside = a;
                return false;
            }
        a = b;
    }
    return true;
}

NodeFormula::NodeFormula(io::Expression f, std::size_t time) : formula(std::move(f)), time(time)
{
    if (formula.variables() > most_variables)
        lie::reject("dae::NodeFormula", "a formula must have at most three variables; their number",
                    formula.variables());
    for (const io::Expression& part : formula.parts_in(time))
        for (io::Expression& g : part.switching_functions(io::Expression::Switches::jumps))
            jumps.push_back(std::move(g));
}

double NodeFormula::value(std::span<const double> variables, double start) const
{
    const double f = formula.value(variables);
    if (jumps.empty()) return f;
    const double t = variables[time], distance = 0.25 * lie::break_distance(t), before = t - distance,
                 after = t + distance;
    const bool jumps_here = std::any_of(jumps.begin(), jumps.end(), [&](const io::Expression& g) {
        return signs_differ(g.value(before), g.value(after)) || (distance == 0 && g.value(t) == 0);
    });
    if (!jumps_here) return f;
    std::array<double, most_variables> at{};
    std::copy(variables.begin(), variables.end(), at.begin());
    const std::span<const double> x(at.data(), variables.size());
    at[time] = t > 0 ? after : std::numeric_limits<double>::min();
    const double f_after = formula.value(x);
    if (!(before > start)) return f_after;
    at[time] = before;
    return 0.5 * (formula.value(x) + f_after);
}

}  // namespace hilda::dae
