// SPDX-License-Identifier: GPL-3.0-or-later
/// Kinematic analysis of driven mechanisms, and inverse dynamics.                         Fang (2022),
/// Sec. 2.1.3

#pragma once

#include "dae/start.hpp"
#include "lie/trajectory.hpp"

namespace hilda::dae {

/// Position, velocity and acceleration of a mechanism without degrees of freedom, at one time after another.
class Kinematics {
public:
    /// The model must be started (dae::start) and have as many independent rows as coordinates:
    /// lie::InvalidInput otherwise, with the number of degrees of freedom.
    explicit Kinematics(const Model& model);

    /// Moves x to the time t: positions by Newton to 1e-13 (Eq. 2.2), velocities (2.8), accelerations (2.9)
    /// and with them the multipliers that the motion needs, which is inverse dynamics. Goes there in substeps
    /// no longer than `substep` [s], each guessed by Taylor from the one before, so that it stays on its
    /// branch.
    void move_to(State& x, double t, double substep = 5e-3);

    /// The states at t_0 + k dt, k = 0 … n
    lie::Trajectory run(State x, double dt, long n);

private:
    const Model& model;
    lie::Saddle K;
};

/// Multipliers that make x's accelerations happen under the loads of the model: the λ of least length with
/// Φ_rᵀ λ = F - M r̈ and Π̄ᵀ λ = τ̄ - J̄ ω̄̇ in the sense of least squares. `missing` receives what no multiplier
/// can supply, as force [N] and torque [N m, body frame] on each body: the actuation the motion needs besides
/// its constraints.
Eigen::VectorXd inverse_dynamics(const Model& model, const State& x,
                                 std::vector<Reaction>* missing = nullptr);

}  // namespace hilda::dae
