// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/saddle_step.hpp"

#include "lie/system.hpp"

#include <cmath>

namespace hilda::lie {

SaddleStep::SaddleStep(const System& model, const Settings& settings)
    : NewtonStep(model, settings), K(model, Metric::mass, settings.linear_solver), b(K.size()),
      nonholonomic_residual(model.pattern().velocity_rows)
{
    z.resize(K.size());
    e.resize(K.size());
}

Statistics SaddleStep::statistics() const { return statistics_with(K); }

void SaddleStep::correct(int k, const State& x, double factor)
{
    if (k == 1) set_linear_residual();
    set_constraint_residual(k, x, factor);
    if (k == 1)
        K.solve(e);
    else
        K.solve_constraints(e);
    z += e;
}

void SaddleStep::set_linear_residual(const Rows& C)
{
    K.multiply(C, z, e);
    e = b - e;
    nonholonomic_residual = velocity_part(e);
}

void SaddleStep::set_constraint_residual(int k, const State& x, double factor)
{
    model.phi(x, K.constraint_part(e));
    K.constraint_part(e) *= -factor;
    if (k == 1) velocity_part(e) = nonholonomic_residual;
}

Eigen::VectorBlock<const Eigen::VectorXd> SaddleStep::motion_part(const Eigen::VectorXd& z) const
{
    return z.head(6 * model.bodies());
}

double SaddleStep::length_of_motion(Eigen::VectorXd& e) const
{
    return std::sqrt(motion_part(e).squaredNorm() + K.algebraic_part(e).squaredNorm());
}

Eigen::VectorBlock<Eigen::VectorXd> SaddleStep::velocity_part(Eigen::VectorXd& z) const
{
    const Eigen::Index rows = nonholonomic_residual.size();
    return z.segment(6 * model.bodies() + model.rows() - rows, rows);
}

void SaddleStep::move_algebraic(State& x, const Eigen::Ref<const Eigen::VectorXd>& change,
                                double factor) const
{
    Eigen::Index at = 0;
    for (const Rows::AlgebraicGroup& group : K.rows().algebraic) {
        x.alpha.segment(group.first_alpha, group.count) += factor * change.segment(at, group.count);
        at += group.count;
    }
}

void SaddleStep::place_algebraic(State& x, double factor)
{
    x.alpha = x_n.alpha;
    if (K.rows().algebraic.empty()) return;
    move_algebraic(x, K.algebraic_part(z), factor);
}

}  // namespace hilda::lie
