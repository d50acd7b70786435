// SPDX-License-Identifier: GPL-3.0-or-later
/// The columns of a run at given instants.

#pragma once

#include "dae/model_file.hpp"
#include "lie/settings.hpp"

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace hilda::lie {
struct Scheme;
}

namespace hilda::run {

/// How a model is integrated
struct SampledRunOptions {
    const lie::Scheme* scheme = nullptr;
    double step = 1e-3;  ///< [s], of a scheme with a fixed step; reduced so that the end is a node
    lie::Settings settings = {};
    bool fix_initial = false;  ///< project inconsistent initial data onto the constraints
};

/// Values of columns at the instants t, in the shape of FitData::values
struct Samples {
    Eigen::MatrixXd values;
    /// Largest estimated error of the interpolation between nodes in each column; 0 if the instants are nodes
    Eigen::VectorXd interpolation;
    std::vector<std::string> warnings;  ///< about the solution
};

/// Nodes [s] of a run of a scheme with adaptive steps: the interval of instants with equal intervals from 0;
/// otherwise a quarter of their median interval, with a limit for instants that are close to each other
double interval_of(const std::vector<double>& t);

/// Integrates the model from 0 to the last instant. Between nodes the columns are interpolated by polynomials
/// of degree 7; their difference from those of degree 5 is the estimated error.
///
/// Throws lie::InvalidInput for an invalid model, io::UsageError for an unknown column, and
/// lie::NumericalFailure.
Samples sample(dae::Description& model, const std::vector<std::string>& columns, const std::vector<double>& t,
               const SampledRunOptions& options);

}  // namespace hilda::run
