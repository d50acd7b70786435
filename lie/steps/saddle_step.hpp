// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the rA schemes: the saddle matrix of t_n is the Newton matrix of the step.

#pragma once

#include "lie/solver/saddle.hpp"
#include "lie/steps/newton_step.hpp"

namespace hilda::lie {

class SaddleStep : public NewtonStep {
public:
    SaddleStep(const System& model, const Settings& settings);

    Statistics statistics() const override;
    const State* pivots() const override { return &K.pivots(); }
    void choose_pivots(const State& x) override { K.choose_pivots(x); }

protected:
    /// Correction k of the unknowns z of the equations K z = b, Φ(x(z)) = 0:
    ///
    ///     K e = (b - K z, -factor Φ),    z ← z + e                         Fang (2022), Eqs. 3.30, 3.31
    ///
    /// The rows of the bodies, of the algebraic variables and the nonholonomic rows are linear in z. Their
    /// residual is zero from the second correction on.
    void correct(int k, const State& x, double factor);

    /// e = b - K z, with the rows of K or with the rows C
    void set_linear_residual() { set_linear_residual(K.rows()); }
    void set_linear_residual(const Rows& C);

    /// Sets the constraint part of e to -factor Φ(x). For k = 1 the nonholonomic rows receive the residual
    /// that set_linear_residual() has computed, for k > 1 zero.
    void set_constraint_residual(int k, const State& x, double factor);

    /// The components (r, θ̄) of all bodies
    Eigen::VectorBlock<const Eigen::VectorXd> motion_part(const Eigen::VectorXd& z) const;
    /// Euclidean norm of the components of the bodies and of the algebraic variables
    double length_of_motion(Eigen::VectorXd& e) const;
    /// The components of the nonholonomic rows, the last rows of the constraints
    Eigen::VectorBlock<Eigen::VectorXd> velocity_part(Eigen::VectorXd& z) const;

    /// x.alpha += factor · change, where `change` lists the algebraic variables group by group
    void move_algebraic(State& x, const Eigen::Ref<const Eigen::VectorXd>& change, double factor = 1) const;
    /// x.alpha = x_n.alpha + factor · (algebraic part of z)
    void place_algebraic(State& x, double factor);

    Saddle K;
    Eigen::VectorXd b;

private:
    Eigen::VectorXd nonholonomic_residual;
};

}  // namespace hilda::lie
