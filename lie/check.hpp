// SPDX-License-Identifier: GPL-3.0-or-later
/// Exceptions for invalid input and for numerical failures.

#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace hilda::lie {

/// Invalid input. what() contains the place, the error and the value.
class InvalidInput : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// Throws InvalidInput "where: what, got value".
template <class Value>
[[noreturn]] void reject(const std::string& where, const std::string& what, const Value& value)
{
    std::ostringstream text;
    text.precision(17);
    text << where << ": " << what << ", got " << value;
    throw InvalidInput(text.str());
}

/// A computation that failed. If a step of an integrator throws it, the state remains that of t_n.
class NumericalFailure : public std::runtime_error {
public:
    NumericalFailure(std::string status, const std::string& what)
        : std::runtime_error(what), status(std::move(status))
    {}

    /// newton_diverged, singular_matrix, nonfinite, constraint_drift, singular_parametrisation, ida_failed,
    /// ...
    std::string status;
};

/// Newton's method has not reached its tolerance.
class NoConvergence : public NumericalFailure {
public:
    NoConvergence(const std::string& what, double correction, int iterations)
        : NumericalFailure("newton_diverged", what), correction(correction), iterations(iterations)
    {}

    double correction;  ///< norm of the last correction, in the units of Settings::tolerance
    int iterations;
    /// Name of the constraint row with the largest |Φ| at the last iterate. Set by integrators only; empty if
    /// there are no rows.
    std::string largest = {};
    double residual = 0;  ///< |Φ| of that row
};

/// A matrix is singular to working precision: redundant or singular constraints.
class SingularMatrix : public NumericalFailure {
public:
    SingularMatrix(const std::string& what, double reciprocal_condition)
        : NumericalFailure("singular_matrix", what), reciprocal_condition(reciprocal_condition)
    {}

    double reciprocal_condition;
};

/// Settings::stop has returned true.
class Interrupted : public NumericalFailure {
public:
    Interrupted() : NumericalFailure("interrupted", "interrupted inside a step") {}
};

/// The model or the solver has computed a number that is not finite.
class NonFinite : public NumericalFailure {
public:
    explicit NonFinite(const std::string& what) : NumericalFailure("nonfinite", what) {}
};

}  // namespace hilda::lie
