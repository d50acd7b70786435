// SPDX-License-Identifier: GPL-3.0-or-later
/// trajectory.csv, and what its rows say about the run.

#pragma once

#include "dae/start.hpp"
#include "lie/trajectory.hpp"
#include "studies/output_file.hpp"

namespace hilda::studies {

/// Over every node of the run
struct Invariants {
    long nodes = 0, rows = 0;                 ///< nodes seen, and rows written of them
    double energy_start = 0, energy_end = 0;  ///< [J]
    double energy_drift = 0;                  ///< largest |E - E_0| [J]
    double constraint_norm = 0;               ///< largest scaled residual, also of dropped rows [m or rad]
    double orthogonality = 0;                 ///< largest ‖AᵀA - I‖
};

/// Writes those nodes that are rows of the grid. Throws lie::NumericalFailure "constraint_drift"
/// at the node where a constraint row that was dropped as redundant stops being so.
class TrajectoryCsv final : public lie::Observer {
public:
    TrajectoryCsv(const dae::Model& model, const lie::Grid& grid, OutputFile& file, bool with_reactions);

    void write_header();
    void accepted(const lie::State& x, long n, int iterations) override;

    Invariants invariants;

private:
    void note(const lie::State& x, double energy, double constraint_norm);

    const dae::Model& model;
    const lie::Grid& grid;
    OutputFile& file;
    const bool with_reactions;
    lie::Rows C;
    std::vector<dae::Reaction> reactions;
};

}  // namespace hilda::studies
