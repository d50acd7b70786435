// SPDX-License-Identifier: GPL-3.0-or-later
/// A consistent start: positions and velocities on their constraints, accelerations and multipliers from the
/// saddle system, and a set of constraint rows that is independent.   Fang (2022), Eqs. 2.2, 2.8, 2.9, 2.17

#pragma once

#include "dae/model.hpp"
#include "lie/solver/saddle.hpp"

namespace hilda::dae {

/// Moves r and A onto Φ(r, A, t) = 0, by Newton steps that are shortest in the metric of the mass. Returns
/// the number of steps. Throws lie::NoConvergence when the residual, scaled, does not fall below `tolerance`
/// [m or rad], or below what rounding makes of it far from the origin.
int project_positions(const Model& model, lie::Saddle& K, State& x, double tolerance = 1e-13);

/// Moves ṙ and ω̄ onto Φ_r ṙ + Π̄ ω̄ = ν, shortest in the metric of the mass: as an ideal impact would.
void project_velocities(const lie::System& system, lie::Saddle& K, State& x);

/// r̈, ω̄̇ and λ of a state that is consistent in position and velocity, from K (r̈, ω̄̇, λ) = (F, τ̄, γ).
void solve_accelerations(const lie::System& system, lie::Saddle& K, State& x);

struct StartOptions {
    bool fix_initial = false;  ///< project data that are off the constraints, instead of refusing them
    double tolerance = 1e-9;   ///< what is off: scaled residual [m or rad, and per second]
};

struct StartReport {
    int rows = 0, rank = 0, degrees_of_freedom = 0;
    std::vector<std::string> dropped;  ///< names of the redundant rows, taken out of the equations
    double position_residual = 0, velocity_residual = 0;  ///< scaled, of the data as given
    std::string worst_position, worst_velocity;           ///< the rows they are in
    bool projected = false;
};

/// Readies model and state: finds the rank of the constraints (SuiteSparseQR), drops redundant rows,
/// projects, and solves for accelerations and multipliers. Data within the tolerance are moved onto the
/// constraints too, which changes them by less than it. Throws lie::InvalidInput, naming the rows, for data
/// off the constraints and for rows that contradict the others in position, velocity or acceleration. Where a force
/// goes by multipliers, as friction goes by the normal force of a contact, both are found together;
/// lie::NumericalFailure "start_not_converged" where they do not settle.
StartReport start(Model& model, State& x, const StartOptions& options = {});

/// Throws lie::NumericalFailure "constraint_drift" when a row that was dropped as redundant is off by more than
/// 1e-6 m or rad in x: then it says something that the others do not, and the motion is not that of the model.
void check_dropped_rows(const Model& model, const State& x);

}  // namespace hilda::dae
