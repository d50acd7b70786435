// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of convergence: errors of runs over their steps, the orders between neighbouring steps, and the
/// slopes fitted through the errors above the floor.

#pragma once

#include "studies/framework/reference_solution.hpp"
#include "studies/framework/sweep.hpp"

namespace hilda::studies {

/// A run with an error in each norm of the study
struct ErrorRun : Run {
    std::vector<double> error = {};  ///< NaN if the run failed
    std::vector<double> order =
        {};  ///< to the next larger step; NaN: unknown, or one of the errors at the floor
    std::vector<char> at_floor = {};  ///< the error does not depend on the step any more: not in the fit
    int instants = 0;                 ///< number of compared instants
    double constraint_norm = 0, orthogonality = 0;  ///< largest at the compared nodes

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.list(error), a.list(at_floor), a.value(instants), a.value(constraint_norm), a.value(orthogonality);
    }
};

/// The runs of one scheme on one benchmark, in descending order of the step: see series_of
using Series = std::vector<const ErrorRun*>;

/// What a study of convergence states about its norms and fits
struct ConvergenceStudy {
    std::vector<std::string> norms;  ///< names
    double asymptotic_step;          ///< the order is fitted through steps up to this one [s] ...
    size_t least_points;             ///< ... or, if there are fewer, through this many of the smallest steps
    std::string prefix_of_errors;    ///< of the columns of the errors in study.csv

    /// Runs each benchmark with each scheme and step, and computes the errors by `errors`, which fills error
    /// and at_floor of a run. --reference replaces the reference solutions.
    Sweep<ErrorRun> runs(const StudyContext& study, const std::vector<Benchmark>& benchmarks,
                         const Schemes& schemes, const std::vector<double>& steps,
                         const std::function<void(ErrorRun&)>& errors) const;

    /// Order of convergence in norm n: the slope fitted through the errors above the floor. Schemes of high
    /// order have few of these among the small steps.
    double fit(const Series& series, size_t n) const;

    /// Keys of --expect. For each norm X: order_X, the fitted order, and X, the error at the smallest step.
    /// `order` is the order_X of the first norm X for which a fit exists.
    std::vector<std::string> keys() const;
    /// The values of these keys
    Measured measured(const Series& series) const;

    /// Columns of the errors, the orders and the floors in study.csv
    Columns<ErrorRun> errors() const;
    Columns<ErrorRun> orders() const;
    Columns<ErrorRun> floors() const;
    /// problem, integrator and reference of a series, its fitted orders and an object for each of its runs
    /// with h, status, the errors and the columns `more`
    io::Json json(const Series& series, const Columns<ErrorRun>& columns,
                  const std::vector<std::string>& more = {},
                  const io::Json& more_of_series = io::Json::object()) const;
};

}  // namespace hilda::studies
