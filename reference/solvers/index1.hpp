// SPDX-License-Identifier: GPL-3.0-or-later
/// The equations of motion as an ordinary differential equation (index 1).       Fang (2022), Eqs. 2.9, 2.17

#pragma once

#include "lie/trajectory.hpp"
#include "reference/solvers/ode.hpp"

namespace hilda::dae {
class Model;
}

namespace hilda::reference {

/// Integrates the index-1 equations of motion and returns the states at the given instants.
///
///     | M  0  Φ_rᵀ | | r̈  |   | F |
///     | 0  J̄  Π̄ᵀ   | | ω̄̇  | = | τ̄ |,    ṗ = ½ Gᵀ ω̄,    p the Euler parameters of A
///     | Φ_r Π̄  0   | | λ  |   | γ |
///
/// by rk8pd. The equations impose Φ̈ = 0 only. Positions and velocities are therefore projected onto the
/// constraints at every instant. Discrete states (branches of drivers, turn counts) are updated after every
/// accepted step of the integrator. The states returned include accelerations and multipliers.
///
/// @param x         initial state, made consistent by dae::start()
/// @param instants  [s], ascending, none before x.t
/// @param tolerance tolerance of a step for r [m], p, ṙ [m/s] and ω̄ [rad/s]
///
/// Throws lie::InvalidInput for instants out of order, for a model without degrees of freedom (its motion
/// follows from kinematics) and for a model with continuous internal states (friction histories): their
/// values depend on the step size, which is adaptive here.
lie::Trajectory index1(const dae::Model& model, const lie::State& x, const std::vector<double>& instants,
                       const OdeTolerance& tolerance = {});

}  // namespace hilda::reference
