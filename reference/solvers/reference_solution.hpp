// SPDX-License-Identifier: GPL-3.0-or-later
/// The motion of any model, by the road that is trusted most for it.

#pragma once

#include "reference/solvers/index1.hpp"

namespace hilda::reference {

/// States at these instants [s], ascending; bodies only, multipliers may be empty.
using ClosedForm = std::function<lie::Trajectory(const std::vector<double>& instants)>;

/// Complete states at these instants, ascending, none before x.t; x is a state that dae::start() has readied.
/// Kinematic analysis where nothing is free, index1() otherwise. InvalidInput where real numbers are remembered.
lie::Trajectory trusted(const dae::Model& model, const lie::State& x, const std::vector<double>& instants);

/// The same by a closed form where it is a motion of the model, with multipliers by inverse dynamics: where
/// it starts at x, its states satisfy the constraints, and the multipliers make up for all that the loads
/// lack. As above where it is none, or the closed form throws InvalidInput or NumericalFailure: a model can
/// be changed in ways that it does not cover.
lie::Trajectory trusted(const dae::Model& model, const lie::State& x, const std::vector<double>& instants,
                        const ClosedForm& closed_form);

}  // namespace hilda::reference
