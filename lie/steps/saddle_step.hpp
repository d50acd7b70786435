// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the rA schemes: the saddle matrix of t_n is the Newton matrix of the step.

#pragma once

#include "lie/solver/saddle.hpp"
#include "lie/steps/newton_step.hpp"

namespace hilda::lie {

/// Newton's method for the equations K z = b, Φ(x(z)) = 0:
///
///     K e = (b - K z, -factor Φ),    z ← z + e                             Fang (2022), Eqs. 3.30, 3.31
class SaddleStep : public NewtonStep {
public:
    /// `springs` is the pattern of the rows of implicit springs, see Saddle.
    SaddleStep(const System& model, const Settings& settings, const Rows& springs = {});

    Statistics statistics() const override;
    const State* pivots() const override { return &K.pivots(); }
    void choose_pivots(const State& x, double h) override;

protected:
    /// e = b - K z, with the rows C in K
    void set_linear_residual(const Rows& C);
    /// Sets the constraint part of e to -factor Φ(x). For k = 1 the nonholonomic rows and those of springs
    /// receive the residual that set_linear_residual() has computed, for k > 1 zero.
    void set_constraint_residual(int k, const State& x, double factor);

    /// J_r(θ)⁻¹ J̄ θ of body i: h times its angular momentum at the beginning of a step with θ = h ω̄, in the
    /// body frame
    Vec3 momentum(int i, const Vec3& theta) const;
    /// Adds J̄ θ - J_r(θ)⁻¹ J̄ θ to the moment equations in e, for schemes that balance momentum(i, θ) in the
    /// place of J̄ θ.
    void balance_momentum();

    Saddle K;
    Eigen::VectorXd b;

private:
    /// The components of the nonholonomic rows and of the springs, the last rows of the constraints
    Eigen::VectorBlock<Eigen::VectorXd> velocity_part(Eigen::VectorXd& z) const;

    Eigen::VectorXd nonholonomic_residual;
};

}  // namespace hilda::lie
