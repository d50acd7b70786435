// SPDX-License-Identifier: GPL-3.0-or-later
/// Nonlinear least squares with bounds: GSL's Levenberg-Marquardt method in a trust region.

#pragma once

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <vector>

namespace hilda::reference {

/// An unknown with open bounds, low < start < high
struct BoundedUnknown {
    double start = 0;
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    double scale = 1;  ///< a typical change, positive
};

struct LeastSquaresProblem {
    std::vector<BoundedUnknown> unknowns;
    /// Residuals at p; false if they cannot be computed there. All calls give the same number.
    std::function<bool(const Eigen::VectorXd& p, Eigen::VectorXd& residuals)> residuals;
    /// ∂residuals/∂p at p, where `residuals` are known
    std::function<void(const Eigen::VectorXd& p, const Eigen::VectorXd& residuals, Eigen::MatrixXd& J)>
        derivatives;
    /// Called after each iteration with its number and the sum of squares
    std::function<void(int iteration, double sum_of_squares)> progress = [](int, double) {};
    int max_iterations = 100;
    double tolerance = 1e-10;  ///< of the last change of an unknown, relative to the unknown
};

struct LeastSquaresSolution {
    Eigen::VectorXd p, residuals;
    int iterations = 0;
    bool has_converged = false;
    const char* reason = "";  ///< why the iteration has ended
};

/// Minimises Σ residuals². The bounds are imposed by the transformation p = low + (high - low) sin² x, or
/// with one bound p = low + (√(x² + 1) - 1) scale, so that p is between them in each evaluation. A bound
/// that is 1e6 scales away from the start is not part of the transformation. A trial step beyond it, or at
/// which the residuals cannot be computed, is refused, and the trust region is reduced. The result does not
/// depend on the scale of the residuals.
///
/// Throws lie::InvalidInput if a start is not between its bounds, if a scale is not positive, or if there are
/// fewer residuals than unknowns; lie::NumericalFailure "fit_start" if the residuals cannot be computed at
/// the start. Rethrows exceptions of the functions.
LeastSquaresSolution minimise(const LeastSquaresProblem& problem);

/// The half width of the two-sided confidence interval with this level in (0, 1), in standard errors: of
/// Student's t distribution with nu degrees of freedom, or of the normal distribution for nu = 0
double confidence_factor(double level, double nu);

}  // namespace hilda::reference
