// SPDX-License-Identifier: GPL-3.0-or-later
/// Reference solution of a model: closed form, kinematic analysis or index-1 equations.

#pragma once

#include "reference/solvers/index1.hpp"

namespace hilda::reference {

/// Closed-form solution: states of the bodies at ascending instants [s]. The multipliers may be empty.
using ClosedForm = std::function<lie::Trajectory(const std::vector<double>& instants)>;

/// States at the given instants, with accelerations and multipliers: by kinematic analysis if the model has
/// no degree of freedom, otherwise by index1().
///
/// @param x         initial state, made consistent by dae::start()
/// @param instants  [s], ascending, none before x.t
///
/// Throws lie::InvalidInput if the state has continuous internal states (friction histories).
lie::Trajectory reference_solution(const dae::Model& model, const lie::State& x,
                                   const std::vector<double>& instants);

/// States at the given instants by a closed form, with multipliers from inverse dynamics.
///
/// The closed form is used only if it is a solution of this model: it starts at x, its states satisfy the
/// constraints on positions and velocities, and loads, inertia and constraint forces are in balance. The
/// tolerance is 1e-9, absolute for positions [m, rad] and relative for velocities and loads. A model with
/// discrete states does not use it. Otherwise, and if the closed form throws lie::InvalidInput or
/// lie::NumericalFailure, the function above is used: a user can change a model such that its closed form no
/// longer applies.
lie::Trajectory reference_solution(const dae::Model& model, const lie::State& x,
                                   const std::vector<double>& instants, const ClosedForm& closed_form);

}  // namespace hilda::reference
