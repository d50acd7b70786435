// SPDX-License-Identifier: GPL-3.0-or-later
/// The prescribed function f(t) of a constraint and its first two derivatives.    Fang (2022), Eqs. 2.5a-d

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/expression.hpp"

namespace hilda::dae {

class FunctionOfTime;
class SampledCurve;

/// A prescribed function of time: a constant, by default 0, an io::Expression in t, or a curve through
/// samples.
///
/// The constructors throw io::ExpressionError for an invalid expression and for a constant that is not
/// finite.
class Driver {
public:
    Driver(double constant = 0);
    Driver(std::string_view text);
    explicit Driver(std::shared_ptr<const SampledCurve> curve);

    double f(double t) const { return constant ? value : curve ? jet(t).f : expression->value(t); }
    double fdot(double t) const { return constant ? 0 : jet(t).fdot; }
    double fddot(double t) const { return constant ? 0 : jet(t).fddot; }
    /// f, ḟ and f̈ together. A curve throws lie::NumericalFailure outside of its samples.
    io::Jet jet(double t) const;

    bool is_constant() const { return constant; }
    /// f with its break points. It must not be constant.
    FunctionOfTime function_of_time() const;
    /// Last time of the samples of a curve [s]; infinite for an expression
    double last_time() const;
    /// Of the expression; empty for a curve
    const std::string& text() const;

    /// sin(g) for f = cos(g) and cos(g) for f = sin(g), if g is not constant. Otherwise empty.
    ///
    /// A DP1 driver f = cos(angle) loses rank at f = ±1, twice per revolution. Near these instants the model
    /// uses the complement, with a reference vector rotated by 90 degrees. See DP1::complement.
    std::optional<Driver> complement() const;

private:
    // Most drivers are constant and are evaluated in every iteration. The value is stored for them.
    bool constant;
    double value = 0;
    std::shared_ptr<const io::Expression> expression;  ///< nullptr: a curve
    std::shared_ptr<const SampledCurve> curve;
};

}  // namespace hilda::dae
