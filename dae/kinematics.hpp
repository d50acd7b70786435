// SPDX-License-Identifier: GPL-3.0-or-later
/// Kinematic analysis of driven mechanisms, and inverse dynamics.                Fang (2022), Sec. 2.1.3

#pragma once

#include "dae/model.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/trajectory.hpp"

namespace hilda::dae {

/// Kinematic analysis: positions, velocities and accelerations of a mechanism without degrees of freedom.
class Kinematics {
public:
    /// dae::start() must have been called for the model, and the model must outlive the object. Throws
    /// lie::InvalidInput if the model has degrees of freedom.
    explicit Kinematics(const Model& model);

    /// Computes the state x at the time t [s] from the state x at its own time.
    ///
    /// Positions follow from Newton's method to 1e-13 m or rad (Eq. 2.2), velocities from (2.8),
    /// accelerations and multipliers from (2.9, 2.17). The multipliers include those of the drivers. The
    /// interval is divided into substeps of at most `substep` [s]. A Taylor expansion of second order gives
    /// the initial guess of each substep. A substep is halved until no body turns by more than 0.3 rad in it,
    /// and until the positions and the velocities that are found are near those that were predicted: the
    /// solution stays on its branch of the assemblies. t may be earlier than x.t.
    ///
    /// Throws lie::NumericalFailure "kinematic_jump" where the motion is not continuous, and that of Newton's
    /// method where the mechanism cannot move on.
    void move_to(State& x, double t, double substep = 5e-3);

    /// The states at x.t + k dt, k = 0, ..., n
    lie::Trajectory run(State x, double dt, long n);

private:
    void advance(State& x, double t, int halvings);
    /// Computes the state at the time t from a prediction. Returns the body whose motion is too far from it,
    /// or an empty string.
    std::string follow(const State& before, State& x, double t);

    const Model& model;
    const double size;  ///< of the mechanism [m]
    lie::Saddle K;
};

/// Inverse dynamics: the multipliers that produce the accelerations of x under the loads of the model.
///
/// λ is the least-squares solution of Φ_rᵀ λ = F - M r̈, Π̄ᵀ λ = τ̄ - J̄ ω̄̇. `unbalanced` receives the
/// negative residual of each body: the force [N, global frame] and the torque [N m, body frame] that must be
/// applied in addition to the constraint loads. The rows must be independent.
Eigen::VectorXd inverse_dynamics(const Model& model, const State& x,
                                 std::vector<Reaction>* unbalanced = nullptr);

}  // namespace hilda::dae
