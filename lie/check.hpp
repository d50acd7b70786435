// SPDX-License-Identifier: GPL-3.0-or-later
/// How bad input is refused, and how a healthy program reports that the numerics failed.

#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace hilda::lie {

/// Input that the mathematics has no answer for. what() says where, what is wrong, and the value.
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

/// A computation that could not be finished. The state is left as it was at t_n.
class NumericalFailure : public std::runtime_error {
public:
    NumericalFailure(std::string status, const std::string& what)
        : std::runtime_error(what), status(std::move(status))
    {}

    std::string
        status;  ///< newton_diverged, singular_matrix, nonfinite, constraint_drift, singular_parametrisation, ida_failed, ...
};

/// Newton's method did not reach its tolerance.
class NoConvergence : public NumericalFailure {
public:
    NoConvergence(const std::string& what, double correction, int iterations)
        : NumericalFailure("newton_diverged", what), correction(correction), iterations(iterations)
    {}

    double correction;  ///< norm of the last correction, in the units of the scheme
    int iterations;
    std::string largest =
        {};  ///< name of the constraint row with the largest residual at the last iterate, if any
    double residual = 0;  ///< that residual, as Phi gives it
};

/// The saddle matrix has no inverse that double precision can use: redundant or singular constraints.
class SingularMatrix : public NumericalFailure {
public:
    SingularMatrix(const std::string& what, double reciprocal_condition)
        : NumericalFailure("singular_matrix", what), reciprocal_condition(reciprocal_condition)
    {}

    double reciprocal_condition;
};

/// Settings::stop said so.
class Interrupted : public NumericalFailure {
public:
    Interrupted() : NumericalFailure("interrupted", "interrupted inside a step") {}
};

/// A number that is not finite came out of the model or the solver.
class NonFinite : public NumericalFailure {
public:
    explicit NonFinite(const std::string& what) : NumericalFailure("nonfinite", what) {}
};

}  // namespace hilda::lie
