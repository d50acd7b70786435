// SPDX-License-Identifier: GPL-3.0-or-later
/// Consistent initial conditions: independent constraint rows, positions and velocities that satisfy them,
/// accelerations and multipliers from the saddle system.               Fang (2022), Eqs. 2.2, 2.8, 2.9, 2.17

#pragma once

#include "lie/state.hpp"

#include <string>
#include <vector>

namespace hilda::dae {

class Model;
using lie::State;

struct StartOptions {
    bool fix_initial = false;  ///< project data that violate the constraints, instead of rejecting them
    double tolerance = 1e-9;   ///< largest scaled residual of the data as given [m or rad, and per second]
};

struct StartReport {
    int rows = 0;       ///< rows of all blocks
    int rank = 0;       ///< independent active rows minus algebraic variables, without regularised rows
    int redundant = 0;  ///< number of redundant rows that are kept, see Model::keep_redundant
    int degrees_of_freedom = 0;                           ///< 6 bodies - rank
    std::vector<std::string> dropped;                     ///< names of the redundant rows that were removed
    double position_residual = 0, velocity_residual = 0;  ///< largest scaled residuals of the data as given
    std::string worst_position, worst_velocity;           ///< names of the rows with these residuals
    /// Violations of these rows in their units, such as "0.1 m" for the distance of two points that must
    /// coincide, or "0.02 rad"
    std::string position_violation, velocity_violation;
    /// For each contact at rest that its friction cannot hold, and for each function of a constraint or a
    /// force that contradicts differences, see wrong_derivatives()
    std::vector<std::string> warnings;
    bool projected = false;  ///< whether one of them exceeded the tolerance
};

/// Prepares the model and the state for a run.
///
/// 1. Model::prepare() checks the data and sets the sizes of the state.
/// 2. dependent_rows() finds the redundant rows, and they are removed from the equations, unless
///    Model::keep_redundant is set.
/// 3. Positions and velocities are projected onto the remaining rows. Data within the tolerance are projected
///    too, which changes them by about the tolerance.
/// 4. Accelerations and multipliers are computed. If a force depends on multipliers, as friction depends on
///    the normal force of a contact, both are iterated with Aitken's extrapolation. Springs of friction
///    between bodies at rest are stretched such that they hold them, see set_static_friction().
///
/// Throws lie::InvalidInput with the name of the row if the data violate a constraint by more than the
/// tolerance and fix_initial is not set, or if a redundant row contradicts the others in position, velocity
/// or acceleration. Throws lie::NumericalFailure "start_not_converged" if the iteration of step 4 does not
/// converge.
StartReport start(Model& model, State& x, const StartOptions& options = {});

/// Step 4 alone, for a start whose loads have changed: State::applied_loads
void set_start_accelerations(const Model& model, State& x);

/// Throws lie::NodeFailure "constraint_drift" if the scaled residual of a row that was removed as
/// redundant exceeds 1e-6 m or rad in x. The row has then become independent of the others, and the computed
/// motion is not that of the model.
void check_dropped_rows(const Model& model, const State& x);

}  // namespace hilda::dae
