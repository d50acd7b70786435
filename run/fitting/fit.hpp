// SPDX-License-Identifier: GPL-3.0-or-later
/// Numbers of a model fitted to measured values, with their uncertainty.
///
/// The estimate minimises χ² = Σ ((model - data) / σ)² over all values. With J = ∂(model/σ)/∂p at the
/// minimum, the covariance of the estimate is (Jᵀ J)⁻¹, for unknown σ times χ²/(values - parameters). The
/// error of the time steps is estimated from a run with half the step, or with a hundredth of the tolerance:
/// its residuals r' give the bias J⁺ (r' - r) of the estimate.

#pragma once

#include "run/fitting/data.hpp"
#include "run/fitting/sampled_run.hpp"

#include <atomic>
#include <limits>
#include <span>

namespace hilda::run {

/// A number of the model that is fitted. Its bounds are open.
struct FitParameter {
    std::string pointer;  ///< /json/pointer
    double start = 0;
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    double scale = 0;  ///< a typical change; 0: |start|, or 1 if that is 0
};

struct FitProblem {
    /// Reads the model with these changes: "/json/pointer=VALUE"
    std::function<dae::Description(std::span<const std::string> set)> read;
    std::vector<FitParameter> parameters;
    FitData data;
    /// Standard deviation of each column; empty: unknown, and the same for all columns, which then must have
    /// the same unit
    std::vector<double> sigma;
    SampledRunOptions run;
    int max_iterations = 100;
    int jobs = 1;                             ///< number of concurrent runs
    bool progress = false;                    ///< on stderr
    const std::atomic<bool>* stop = nullptr;  ///< ends the runs, of all threads, when it is true
};

struct FittedParameter {
    std::string pointer;
    double value = 0;
    double error = 0;                ///< standard error; NaN if the data do not determine it
    double low_95 = 0, high_95 = 0;  ///< confidence interval of 95 %
    double bias = 0;                 ///< estimated error by the time steps; NaN: unknown
    bool at_bound = false;           ///< the minimum is at a bound, so that the standard error has no meaning
};

struct FitResult {
    std::vector<FittedParameter> parameters;
    Eigen::MatrixXd covariance;
    double chi_squared = 0;
    double sigma = 1;  ///< estimated standard deviation of the data, if it was unknown; otherwise √(χ²/ν)
    long values = 0, degrees_of_freedom = 0;
    /// Of J times the scales, descending. The scale of a parameter without one is its value.
    Eigen::VectorXd singular_values;
    Eigen::MatrixXd directions;      ///< of these singular values, in units of the scales
    Samples samples;                 ///< of the fitted model
    std::vector<std::string> units;  ///< of the columns
    dae::Description model;          ///< the fitted model
    int iterations = 0;
    long runs = 0;
    bool has_converged = false;
    std::string reason;
    std::vector<std::string> warnings;
};

/// The number of a model at a pointer, or /parameters/NAME. io::UsageError if there is none.
double number_at(const dae::Description& model, const std::string& pointer);

/// Throws lie::InvalidInput for an invalid model, data, parameter or start; io::UsageError for an unknown
/// column or columns of different units without `sigma`; lie::NumericalFailure if the run with the start
/// fails. Runs that fail with other values are avoided. lie::Interrupted if *stop is true.
FitResult fit(const FitProblem& problem);

}  // namespace hilda::run
