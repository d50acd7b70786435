// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs of a study with their errors against the reference solution of the benchmark.

#pragma once

#include "lie/settings.hpp"
#include "studies/framework/run.hpp"

namespace hilda::studies {

struct EvaluatedRun : Run {
    Errors errors = {};                             ///< NaN if the run failed
    double constraint_norm = 0, orthogonality = 0;  ///< largest at the compared nodes
    lie::Trajectory nodes = {};                     ///< the compared nodes ...
    std::vector<long> at = {};                      ///< ... and their rows in the reference solution
};

/// Integrates the run and stores its errors and invariants in it. `of_study`: settings of the study.
void evaluate(EvaluatedRun& run, const lie::Settings& of_study);

/// The norms of errors.hpp for the difference of two runs of the same benchmark at the same nodes
Errors difference(const EvaluatedRun& a, const EvaluatedRun& b);

/// Collects the nodes that are rows of the reference solution, and the largest constraint norm [m or rad] and
/// ‖AᵀA - I‖ at these nodes. lie::NumericalFailure "constraint_drift" if a dropped constraint row is
/// violated.
class AtInstants final : public lie::Observer {
public:
    AtInstants(const dae::Model& model, const Instants& instants, double h)
        : model(model), instants(instants), h(h)
    {}

    void accepted(const lie::State& x, long n, int iterations) override;

    std::vector<long> at;
    lie::Trajectory run;
    double constraint_norm = 0, orthogonality = 0;

private:
    const dae::Model& model;
    const Instants& instants;
    const double h;
};

}  // namespace hilda::studies
