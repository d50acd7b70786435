// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions of time in loads and drivers: where they are not smooth, and where they change within a step.

#pragma once

#include "io/arithmetic/range.hpp"
#include "io/expression.hpp"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hilda::dae {

class SampledCurve;

/// A function of time, with bounds by interval arithmetic. Zeros and pulses are found however short they are,
/// as long as the bounds of the formula need no more than a few thousand subdivisions of an interval.
class FunctionOfTime {
public:
    explicit FunctionOfTime(io::Expression f);
    explicit FunctionOfTime(std::shared_ptr<const SampledCurve> curve);

    /// The first place in (from, to] where the function may have a jump or a kink, to the last digits of t
    std::optional<double> first_break(double from, double to) const;

    /// The end of an interval from `from`, at most to `to`, in which the function is monotone, or differs
    /// from its chord in each quarter by at most a quarter of the variation of the five values there. The
    /// stages of a step of this length see each pulse. There must be no break point inside.
    double resolved_until(double from, double to) const;

    double value(double t) const;
    bool has_breaks() const { return !switching.empty(); }

private:
    bool is_resolved(double from, double to, double& pulse) const;
    struct Point {
        double t, f;
    };
    bool is_near_chord(const Point& from, const Point& to, double margin, double& outside) const;
    bool knots_are_near_chord(const Point& from, const Point& to, double margin, double& outside) const;
    io::RangeJet bounds(double from, double to) const;

    std::optional<io::Expression> formula;
    double scale = 0;                       ///< of the values
    std::vector<io::Expression> switching;  ///< their zeros are the break points
    std::shared_ptr<const SampledCurve> curve;
};

/// A load formula at a node of a scheme with fixed steps. Where it jumps at this time, it is the mean of the
/// values on both sides, so that the steps before and after the node get half of the jump each; at the start
/// of the run it is the value after the jump.
class NodeFormula {
public:
    static constexpr std::size_t most_variables = 3;
    /// `time` is the number of the variable t. Throws lie::InvalidInput for more variables.
    NodeFormula(io::Expression f, std::size_t time);

    /// The value for these variables; those of the numbers that jumps compare are within rounding of t
    double value(std::span<const double> variables, double start) const;
    double value(double t, double start) const { return value({&t, 1}, start); }

    io::Expression formula;

private:
    std::size_t time;
    std::vector<io::Expression> jumps;  ///< in t; their zeros are jumps
};

}  // namespace hilda::dae
