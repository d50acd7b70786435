// SPDX-License-Identifier: GPL-3.0-or-later
/// What judges the runs of a study: the problem's own truth, or the integrator that --reference names.

#pragma once

#include "studies/framework/benchmark.hpp"

namespace hilda::studies {

/// What is judged, for what judges it must be finer.
struct Evaluated {
    double smallest_step = 0;  ///< of the integrators with a fixed step [s]; 0: there are none
    double smallest_rtol = 0;  ///< of those that choose their own; 0: there are none
    int highest_order = 0;     ///< of those with a fixed step
};

class Reference {
public:
    /// UsageError for a reference that is coarser than what it judges, unless --force is given: its step must
    /// be smaller than theirs and its order not lower, its rtol ten times smaller, and at most 1e-8.
    Reference(const std::string& kind, const StudyOptions& options, const Evaluated& evaluated);

    /// Gives each case its truth at its instants, a row for each from t = 0 on, side by side.
    void evaluate(std::vector<Benchmark>& benchmarks) const;

private:
    void evaluate(Benchmark& c) const;
    lie::Trajectory by_integrator(const Benchmark& c) const;
    double step(const Benchmark& c) const;

    const StudyOptions& options;
    const lie::Scheme* scheme = nullptr;  ///< none: the problem's own truth
    double h = 0;                         ///< wanted [s]; 0: the interval of the instants
    double rtol = 0;
};

}  // namespace hilda::studies
