// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the one-step methods in the local coordinates of a step: explicit Runge-Kutta and Radau.

#pragma once

#include "lie/steps/node_step.hpp"

namespace hilda::lie {

/// Stages of a Runge-Kutta-Munthe-Kaas method. NodeStep::finish() is the projection at its end.
///
///     A = A_n exp(θ̃),   θ̇ = J_r(θ)⁻¹ ω̄,   (r̈, ω̄̇, λ) from K (r̈, ω̄̇, λ) = (F, τ̄, γ)
///
/// is a differential equation for (r, θ, ṙ, ω̄) of each body.  Munthe-Kaas (1998), BIT 38, 92-111. The state
/// at the beginning of the step is x_n; its accelerations are known.
class LocalCoordinateStep : public NodeStep {
public:
    LocalCoordinateStep(const System& model, const Settings& settings);

protected:
    using Vec12 = Eigen::Matrix<double, 12, 1>;

    /// Number of the variables (r, θ, ṙ, ω̄) of all bodies
    int variables() const { return 12 * bodies; }
    /// Makes x_n the origin of the variables, before the first slope of a step from there.
    void begin_stages() { theta.setZero(); }
    /// Square of the Euclidean norm of an error of the variables, divided by the tolerances of (r, θ, ṙ, ω̄)
    /// of the bodies
    double square_over(const Eigen::VectorXd& tolerance, const Eigen::VectorXd& error) const
    {
        return error.cwiseQuotient(tolerance).squaredNorm();
    }

    /// slope = d/dt (r, θ, ṙ, ω̄) of the stage x, whose θ place() has set
    void set_slope(const State& x, Eigen::Ref<Eigen::VectorXd> slope) const;

    /// The poses and velocities of x are those of x_n changed by d, the increments of (r, θ, ṙ, ω̄).
    void place(State& x, const Eigen::VectorXd& d);

    Eigen::VectorXd theta;  ///< θ of each body at the stage
};

}  // namespace hilda::lie
