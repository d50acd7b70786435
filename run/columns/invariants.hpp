// SPDX-License-Identifier: GPL-3.0-or-later
/// Extreme values over all nodes of a run.

#pragma once

#include "dae/model.hpp"
#include "run/columns/contact_rows.hpp"

#include <limits>
#include <string>
#include <vector>

namespace hilda::run {

/// Extreme values of a contact constraint over all nodes of a run
struct ContactExtremes {
    double F_N_least = std::numeric_limits<double>::infinity();
    double F_N_most = -std::numeric_limits<double>::infinity();  ///< normal force [N]
    double lambda_N = 0;  ///< largest |λ_N| [N]; 0 if the given normals are those of the surfaces

    /// Level of rounding errors of the normal force [N]: 1e-9 Σ m max(1 m/s², |g|)
    static double rounding(const dae::Model& model)
    {
        double sum = 0;
        for (const double m : model.mass().m) sum += m;
        return 1e-9 * sum * std::max(1.0, model.gravity.norm());
    }

    /// Upper limit of |λ_N| / |F_N| that rounding errors explain
    static constexpr double allowed = 1e-6;
    bool normals_differ() const
    {
        return lambda_N > allowed * std::max(std::abs(F_N_least), std::abs(F_N_most));
    }
};

/// Extreme values over all nodes of a run
struct Invariants {
    long nodes = 0, rows = 0;                 ///< number of nodes, and of rows written
    double energy_start = 0, energy_end = 0;  ///< [J]
    double energy_drift = 0;                  ///< largest |E - E_0| [J]
    double constraint_norm = 0;               ///< largest scaled residual, also of dropped rows [m or rad]
    double orthogonality = 0;                 ///< largest ‖AᵀA - I‖
    std::vector<ContactExtremes> contact;     ///< for each contact constraint

    /// Includes a node. contacts: those of the model
    void update(const dae::Model& model, const std::vector<const contact::EvolvingContact*>& contacts,
                const lie::State& x, double energy, double constraint_norm);
};

/// What the extreme values show to be wrong in a run: λ_N is not zero if a surface returns normals that are
/// not those of its points; a negative F_N in a bilateral contact means that bodies free to separate would
/// have separated; the residual of constraints with redundant rows is large.
std::vector<std::string> warnings(const Invariants& of, const dae::Model& model);

}  // namespace hilda::run
