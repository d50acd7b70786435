// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/local_coordinate_step.hpp"

namespace hilda::lie {

LocalCoordinateStep::LocalCoordinateStep(const System& model, const Settings& settings)
    : NodeStep(model, settings), theta(Eigen::VectorXd::Zero(3 * bodies))
{}

void LocalCoordinateStep::set_slope(const State& x, Eigen::Ref<Eigen::VectorXd> slope) const
{
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x.body[i];
        slope.segment<12>(12 * i) << body.rdot,
            right_jacobian_inverse(theta.segment<3>(3 * i)) * body.omega_bar, body.rddot, body.omegadot_bar;
    }
}

void LocalCoordinateStep::place(State& x, const Eigen::VectorXd& d)
{
    for (int i = 0; i < bodies; ++i) {
        const Motion& from = x_n.body[i];
        Motion& body = x.body[i];
        const Vec12 change = d.segment<12>(12 * i);
        theta.segment<3>(3 * i) = change.segment<3>(3);
        body.r = from.r + change.head<3>();
        body.A = from.A * exp(change.segment<3>(3));
        body.rdot = from.rdot + change.segment<3>(6);
        body.omega_bar = from.omega_bar + change.tail<3>();
    }
}

}  // namespace hilda::lie
