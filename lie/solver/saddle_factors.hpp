// SPDX-License-Identifier: GPL-3.0-or-later
/// The factors of a saddle matrix, by one of the solvers of Saddle.

#pragma once

#include <Eigen/Core>

namespace hilda::lie {

/// The factors of
///
///     | M  Cᵀ |
///     | C  -d |,    C = (Φ_r, Π̄), M = diag(M, J̄), d: compliances of the regularised rows
///
/// KluSaddle and Condensed implement this interface. They differ in what a factorisation needs: KluSaddle has
/// pivots and takes algebraic variables, Condensed has a shift for dependent rows.
class SaddleFactors {
public:
    virtual ~SaddleFactors() = default;

    /// Solves in place: (f, g) on entry, (x, λ) on return. Algebraic variables are the last components.
    virtual void solve(Eigen::VectorXd& b) = 0;
    /// The same for f = 0; the f in b is not read.
    virtual void solve_constraints(Eigen::VectorXd& b) = 0;
    /// For the last factorisation: KLU's estimate for the scaled matrix, or the smallest relative pivot of
    /// the condensed matrix
    virtual double reciprocal_condition() const = 0;
};

}  // namespace hilda::lie
