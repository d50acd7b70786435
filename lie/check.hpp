// SPDX-License-Identifier: GPL-3.0-or-later
/// Exceptions of numerical failures.

#pragma once

#include "io/error.hpp"

#include <string>

namespace hilda::lie {

using io::InvalidInput;
using io::NumericalFailure;
using io::reject;

/// Newton's method has not reached its tolerance.
class NoConvergence : public NumericalFailure {
public:
    NoConvergence(const std::string& what, double correction, int iterations)
        : NumericalFailure("newton_diverged", what), correction(correction), iterations(iterations)
    {}

    double correction;  ///< norm of the last correction, in the units of Settings::tolerance
    int iterations;
    double rate = 0;  ///< mean ratio of a correction to the one before; 0: not known
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
