// SPDX-License-Identifier: GPL-3.0-or-later
/// A member that is compared with the truth of its case.

#pragma once

#include "studies/framework/run.hpp"

namespace hilda::studies {

struct EvaluatedRun : Run {
    Errors errors;                                  ///< NaN where the run failed
    double constraint_norm = 0, orthogonality = 0;  ///< largest at the instants
};

/// Integrates; errors and invariants into `run`.
void evaluate(EvaluatedRun& run, const lie::Settings& of_study);

/// Keeps the nodes that are instants of the truth, and what the invariants were there.
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
