// SPDX-License-Identifier: GPL-3.0-or-later
/// Kinematic analysis and inverse dynamics with the saddle matrix.
#include "dae/kinematics.hpp"

#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"

namespace hilda::dae {

namespace {

const Model& require_no_freedom(const Model& model)
{
    if (model.keep_redundant)
        lie::reject("dae::Kinematics",
                    "kinematic analysis needs independent rows; use \"redundant\": \"drop\"", "keep");
    const int degrees_of_freedom = 6 * model.bodies() - model.rows();
    if (degrees_of_freedom != 0)
        lie::reject("dae::Kinematics", "the model must have 0 degrees of freedom", degrees_of_freedom);
    return model;
}

}  // namespace

Kinematics::Kinematics(const Model& model) : model(require_no_freedom(model)), K(model) {}

void Kinematics::move_to(State& x, double t, double substep)
{
    const double t_0 = x.t;
    const auto n = static_cast<long>(std::max(1.0, std::ceil(std::abs(t - t_0) / substep)));
    for (long k = 1; k <= n; ++k) {
        const State before = x;
        x.t = k == n ? t : t_0 + (t - t_0) * static_cast<double>(k) / static_cast<double>(n);
        const double h = x.t - before.t;
        for (Motion& body : x.body) {
            body.r += h * body.rdot + 0.5 * h * h * body.rddot;
            body.A = body.A * lie::exp(h * body.omega_bar + 0.5 * h * h * body.omegadot_bar);
        }
        lie::project_positions(model, K, x);
        lie::project_velocities(model, K, x);
        lie::solve_accelerations(model, K, x);
        model.accepted(before, x);
    }
}

lie::Trajectory Kinematics::run(State x, double dt, long n)
{
    lie::Trajectory trajectory;
    trajectory.row.push_back(x);
    const double t_0 = x.t;
    for (long k = 1; k <= n; ++k) {
        move_to(x, t_0 + static_cast<double>(k) * dt);
        trajectory.row.push_back(x);
    }
    return trajectory;
}

Eigen::VectorXd inverse_dynamics(const Model& model, const State& x, std::vector<Reaction>* unbalanced)
{
    lie::Saddle K(model, lie::Metric::unit);  // [1 Cᵀ; C 0] (residual, λ) = (loads - M a, 0)
    K.assemble(x);
    lie::Loads loads(model.bodies());
    Eigen::VectorXd b(K.size());
    lie::set_load_terms(model, K, x, loads, b);
    for (int i = 0; i < model.bodies(); ++i) {
        b.segment<3>(6 * i) -= model.mass().m[i] * x.body[i].rddot;
        b.segment<3>(6 * i + 3) -= model.mass().J_bar[i] * x.body[i].omegadot_bar;
    }
    K.constraint_part(b).setZero();
    K.solve_refined(b);
    if (unbalanced != nullptr) {
        unbalanced->assign(x.body.size(), {});
        for (int i = 0; i < model.bodies(); ++i)
            (*unbalanced)[i] = {-b.segment<3>(6 * i), -b.segment<3>(6 * i + 3)};
    }
    return K.constraint_part(b);
}

}  // namespace hilda::dae
