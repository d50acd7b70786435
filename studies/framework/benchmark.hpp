// SPDX-License-Identifier: GPL-3.0-or-later
/// A benchmark of a study: a problem with its initial state, end time, observable and reference solution.

#pragma once

#include "studies/framework/errors.hpp"

#include <functional>
#include <memory>

namespace hilda::studies {

struct StudyOptions;

struct Benchmark {
    Problem problem;
    std::vector<std::string> set;  ///< changes of the entries of the model, as those of --set
    std::shared_ptr<const dae::Description>
        started;            ///< model and consistent initial state, shared by the runs
    double end = 0;         ///< [s]
    Observable observable;  ///< its body name is not empty

    // For studies that compute errors (see reference_solution.hpp):
    Instants instants;
    lie::Trajectory reference_solution;
    std::string reference_name;
    Errors size;         ///< norms of the reference solution itself
    Errors uncertainty;  ///< estimated errors of the reference solution: see Reference::estimate_errors
};

/// Reads the model of a benchmark once more, and computes its consistent initial state. lie::InvalidInput.
dae::Description read_and_start(const Benchmark& benchmark, const StudyOptions& options);

/// End time of a model without --end [s]
using DefaultEnd = std::function<double(const dae::Description&)>;
double end_of_model(const dae::Description& d);

/// Benchmarks of the problems of --problem, or of the problems `defaults` without --problem. They are read in
/// sequence, so that the first error is reproducible. Warnings name redundant constraint rows. io::UsageError
/// for two problems with the same name, lie::InvalidInput for an invalid model.
std::vector<Benchmark> benchmarks(const std::string& kind, const StudyOptions& options,
                                  const std::vector<std::string>& defaults,
                                  const DefaultEnd& end = end_of_model);

/// Benchmark of one problem
Benchmark make_benchmark(Problem problem, const StudyOptions& options, const DefaultEnd& end = end_of_model);

/// io::UsageError for a step that does not divide the end time, is larger than `most` [s], or exceeds the
/// stability limit of a force.
void check_steps(const std::string& kind, const Benchmark& c, const std::vector<double>& steps, double most);
void check_steps(const std::string& kind, const Benchmark& c, const std::vector<double>& steps);

}  // namespace hilda::studies
