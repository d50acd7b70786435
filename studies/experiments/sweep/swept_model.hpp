// SPDX-License-Identifier: GPL-3.0-or-later
/// The model of a sweep with each combination of the values.

#pragma once

#include "studies/experiments/sweep/swept_values.hpp"
#include "studies/framework/benchmark.hpp"

namespace hilda::studies {

class SweptModel {
public:
    /// `options` must outlive this object.
    SweptModel(const StudyOptions& options, Problem problem, std::vector<SweptEntry> entries)
        : options(options), problem(std::move(problem)), entries(std::move(entries))
    {}

    /// "double_pendulum with /bodies/0/mass=2": the model with combination k
    std::string name(size_t k) const;
    /// The benchmark of combination k, with its model. lie::InvalidInput, which names --sweep;
    /// lie::NumericalFailure if there is no consistent start.
    Benchmark benchmark(size_t k) const;

private:
    std::vector<std::string> changes(size_t k) const;

    const StudyOptions& options;
    const Problem problem;
    const std::vector<SweptEntry> entries;
};

}  // namespace hilda::studies
