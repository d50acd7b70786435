// SPDX-License-Identifier: GPL-3.0-or-later
/// What a study is of: a problem, started, over a time, with the truth its runs are judged by.

#pragma once

#include "studies/framework/errors.hpp"
#include "studies/framework/study.hpp"

#include <functional>
#include <memory>

namespace hilda::studies {

struct Benchmark {
    Problem problem;
    std::shared_ptr<const dae::Description> started;  ///< shared by the runs, which change nothing in it
    double end = 0;                                   ///< [s]
    Observable observable;                            ///< with the name of its body

    // Of studies with a truth: see truth.hpp.
    Instants instants;
    lie::Trajectory reference_solution;
    std::string reference_name;
    Errors size;
};

/// Reads a problem and readies it for a run.
dae::Description ready(const Problem& problem, const StudyOptions& options);

/// Until when a problem is followed when --end does not say
using DefaultEnd = std::function<double(const dae::Description&)>;
inline double end_of_model(const dae::Description& d) { return d.end; }

/// The problems of --problem, or else these: read and started one after the other, so that the first error is
/// always the same one. Says on stderr what models drop. UsageError for two of one name.
std::vector<Benchmark> benchmarks(const std::string& kind, const StudyOptions& options,
                                  const std::vector<std::string>& otherwise,
                                  const DefaultEnd& end = end_of_model);

/// One of them
Benchmark make_benchmark(Problem problem, const StudyOptions& options, const DefaultEnd& end = end_of_model);

/// UsageError for a step that does not divide the end, or is longer than `most` [s].
void check_steps(const std::string& kind, const Benchmark& c, const std::vector<double>& steps, double most);
void check_steps(const std::string& kind, const Benchmark& c, const std::vector<double>& steps);

}  // namespace hilda::studies
