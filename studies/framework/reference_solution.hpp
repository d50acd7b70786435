// SPDX-License-Identifier: GPL-3.0-or-later
/// Reference solutions of a study: those of the problems, or those of the integrator given by --reference.

#pragma once

#include "studies/framework/study_context.hpp"

namespace hilda::studies {

/// The finest runs of a study; the reference solution must be more accurate.
struct Evaluated {
    double smallest_step = 0;  ///< of the integrators with a fixed step [s]; 0: no such integrator
    double smallest_rtol = 0;  ///< of the integrators with adaptive steps; 0: no such integrator
    int highest_order = 0;     ///< of the integrators with a fixed step
};
/// The finest runs of these schemes, with this smallest step [s] and this smallest rtol
Evaluated finest(const Schemes& schemes, double step, double rtol = 0);

/// Computes the reference solutions of benchmarks.
class Reference {
public:
    /// io::UsageError, unless --accept-reference is given, for a reference integrator that is not more
    /// accurate than the runs: its step must be smaller and its order not lower than theirs; its rtol must be
    /// ten times smaller than theirs, and at most 1e-8 for runs with a fixed step.
    Reference(const StudyContext& context, const Evaluated& evaluated);

    /// Computes the reference solution of each benchmark at its instants, with a row for each from t = 0 on.
    /// The benchmarks are computed concurrently. A model file with internal states (compliant contacts,
    /// friction) has no reference solution with adaptive steps: without --reference its reference is
    /// rA-half-1-momentum, or rA-rkmk-4 for runs of a higher order, with a tenth of the smallest step, after
    /// a warning. io::UsageError for steps [s] that do not have these instants as nodes.
    void evaluate(std::vector<Benchmark>& benchmarks, const std::vector<double>& steps = {}) const;

    /// Estimates the errors of the reference solutions: Benchmark::uncertainty receives the norms of their
    /// difference to second solutions, which are about ten times less accurate. These are the index-1
    /// equations with ten times the tolerance and other steps, kinematic analysis with other substeps for a
    /// model without degrees of freedom, and otherwise the same integrator with ten times the rtol or twice
    /// the step. The second solution of the equations of motion starts from a state that differs by rounding
    /// errors, which the motion amplifies.
    void estimate_errors(std::vector<Benchmark>& benchmarks) const;

private:
    void evaluate(Benchmark& c) const;
    lie::Trajectory less_accurate(const Benchmark& c) const;
    const lie::Scheme* scheme_for(const Benchmark& c) const;
    lie::Trajectory by_integrator(const Benchmark& c, const lie::Scheme& reference, double coarser = 1) const;
    double step(const Benchmark& c) const;

    const StudyContext& context;
    const StudyOptions& options;
    const lie::Scheme* scheme = nullptr;  ///< nullptr: the reference solution of the problem
    int highest_order = 0;                ///< of the integrators with a fixed step that are evaluated
    double h = 0;                         ///< requested step [s]; 0: the interval of the instants
    double rtol = 0;
};

}  // namespace hilda::studies
