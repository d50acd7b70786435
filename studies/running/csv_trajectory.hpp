// SPDX-License-Identifier: GPL-3.0-or-later
/// trajectory.csv, and what its rows say about the run.

#pragma once

#include "dae/start.hpp"
#include "lie/trajectory.hpp"
#include "studies/output_file.hpp"
#include "studies/running/contact_rows.hpp"

#include <limits>

namespace hilda::studies {

/// What became of a contact that evolves, over every node of the run
struct ContactExtremes {
    double F_N_least = std::numeric_limits<double>::infinity();
    double F_N_most = -std::numeric_limits<double>::infinity();  ///< [N]
    double lambda_N = 0;  ///< largest |λ_N| [N]: what the normals lack of being those of the surfaces

    /// What may be rounding where nothing presses: 1e-9 of all weights, or of as many kilograms in 1 m/s² [N]
    static double rounding(const dae::Model& model)
    {
        double sum = 0;
        for (const double m : model.mass().m) sum += m;
        return 1e-9 * sum * std::max(1.0, model.gravity.norm());
    }

    /// λ_N above this part of F_N is no rounding.
    static constexpr double allowed = 1e-6;
    bool normals_differ() const
    {
        return lambda_N > allowed * std::max(std::abs(F_N_least), std::abs(F_N_most));
    }
};

/// Over every node of the run
struct Invariants {
    long nodes = 0, rows = 0;                 ///< nodes seen, and rows written of them
    double energy_start = 0, energy_end = 0;  ///< [J]
    double energy_drift = 0;                  ///< largest |E - E_0| [J]
    double constraint_norm = 0;               ///< largest scaled residual, also of dropped rows [m or rad]
    double orthogonality = 0;                 ///< largest ‖AᵀA - I‖
    std::vector<ContactExtremes> contact;     ///< of each contact that evolves
};

/// Writes those nodes that are rows of the grid. Throws lie::NumericalFailure "constraint_drift"
/// at the node where a constraint row that was dropped as redundant stops being so.
class TrajectoryCsv final : public lie::Observer {
public:
    TrajectoryCsv(const dae::Model& model, const lie::TimeGrid& grid, OutputFile& file, bool with_reactions);

    void write_header();
    void accepted(const lie::State& x, long n, int iterations) override;

    Invariants invariants;

private:
    void note(const lie::State& x, double energy, double constraint_norm);
    void write_contacts(const lie::State& x);
    bool rubs(size_t k) const;

    const dae::Model& model;
    const lie::TimeGrid& grid;
    OutputFile& file;
    const bool with_reactions;
    std::vector<const contact::EvolvingContact*> contacts;
    std::vector<ContactForces> beside;  ///< the constraints of these contacts
    lie::Rows C;
    std::vector<dae::Reaction> reactions;
};

}  // namespace hilda::studies
