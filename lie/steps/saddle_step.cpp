// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/saddle_step.hpp"

#include "lie/system.hpp"

namespace hilda::lie {

SaddleStep::SaddleStep(const System& model, const Settings& settings, const Rows& springs)
    : NewtonStep(model, settings), K(model, Metric::mass, settings.linear_solver, springs), b(K.size()),
      nonholonomic_residual(K.rows().velocity_rows)
{
    z.resize(K.size());
    e.resize(K.size());
}

Statistics SaddleStep::statistics() const { return statistics_with(K); }
void SaddleStep::choose_pivots(const State& x, double /*h*/) { K.choose_pivots(x); }

void SaddleStep::set_linear_residual(const Rows& C)
{
    K.multiply(C, z, e);
    e = b - e;
    nonholonomic_residual = velocity_part(e);
}

void SaddleStep::set_constraint_residual(int k, const State& x, double factor)
{
    auto rows = K.constraint_part(e);
    model.phi(x, rows.head(model.rows()));
    rows *= -factor;
    if (k == 1)
        velocity_part(e) = nonholonomic_residual;
    else
        rows.tail(K.rows().springs).setZero();
}

Vec3 SaddleStep::momentum(int i, const Vec3& theta) const
{
    return right_jacobian_inverse(theta) * (mass.J_bar[i] * theta);
}

void SaddleStep::balance_momentum()
{
    for (int i = 0; i < bodies; ++i) {
        const Vec3 theta = z.segment<3>(6 * i + 3);
        e.segment<3>(6 * i + 3) -= momentum(i, theta) - mass.J_bar[i] * theta;
    }
}

Eigen::VectorBlock<Eigen::VectorXd> SaddleStep::velocity_part(Eigen::VectorXd& z) const
{
    const Eigen::Index rows = nonholonomic_residual.size();
    return z.segment(6 * bodies + K.rows().rows() - rows, rows);
}

}  // namespace hilda::lie
