// SPDX-License-Identifier: GPL-3.0-or-later
/// The equations of motion as an ordinary differential equation (index 1).       Fang (2022), Eqs. 2.9, 2.17

#pragma once

#include "dae/model.hpp"
#include "lie/trajectory.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// States at these instants [s], ascending, none before x.t; x is a state that dae::start() has readied.
///
///     | M  0  Φ_rᵀ | | r̈  |   | F |
///     | 0  J̄  Π̄ᵀ   | | ω̄̇  | = | τ̄ |,    ṗ = ½ Gᵀ ω̄,    p the Euler parameters of A
///     | Φ_r Π̄  0   | | λ  |   | γ |
///
/// integrated by rk8pd. Only the second derivative of Φ is held at zero, so positions and velocities are put
/// back on their constraints at every instant; drivers are swapped, and forces remember, at every step of the
/// integrator. States are complete: with accelerations and multipliers.
///
/// Refuses a model without degrees of freedom (lie::InvalidInput): its motion is kinematics. Refuses a model
/// that remembers real numbers: what they are depends on the steps, which nobody here chooses.
lie::Trajectory index1(const dae::Model& model, const lie::State& x, const std::vector<double>& instants,
                       const OdeTolerance& tolerance = {});

}  // namespace hilda::reference
