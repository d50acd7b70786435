// SPDX-License-Identifier: GPL-3.0-or-later
/// Kinematic analysis and inverse dynamics with the saddle matrix.
#include "dae/kinematics.hpp"

#include "io/message.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"

#include <algorithm>
#include <cmath>

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

/// A length of the mechanism [m]: the largest radius of gyration of a body
double size_of(const Model& model)
{
    double largest = 0;
    for (int b = 0; b < model.bodies(); ++b)
        largest = std::max(largest, std::sqrt(model.mass().J_bar[b].trace() / model.mass().m[b]));
    return largest;
}

constexpr double largest_turn = 0.3;  ///< of a body in a substep [rad]
/// Largest error of the prediction: a fraction of the motion in the substep, and a part for motions from rest
constexpr double relative_error = 0.1, absolute_error = 1e-3;
/// A substep of 5 ms is halved to 5e-12 s
constexpr int most_halvings = 30;

}  // namespace

Kinematics::Kinematics(const Model& model) : model(require_no_freedom(model)), size(size_of(model)), K(model)
{}

void Kinematics::move_to(State& x, double t, double substep)
{
    const double t_0 = x.t;
    const auto n = static_cast<long>(std::max(1.0, std::ceil(std::abs(t - t_0) / substep)));
    for (long k = 1; k <= n; ++k)
        advance(x, k == n ? t : t_0 + (t - t_0) * static_cast<double>(k) / static_cast<double>(n), 0);
}

void Kinematics::advance(State& x, double t, int halvings)
{
    const State before = x;
    try {
        const std::string far = follow(before, x, t);
        if (far.empty()) return model.accepted(before, x);
        if (halvings == most_halvings)
            throw lie::NumericalFailure(
                "kinematic_jump",
                io::formatted("the motion of body '%s' is not continuous at t = %.6g s", far.c_str(), t));
    } catch (const lie::NumericalFailure&) {
        if (halvings == most_halvings) throw;
    }
    x = before;
    advance(x, before.t + 0.5 * (t - before.t), halvings + 1);
    advance(x, t, halvings + 1);
}

std::string Kinematics::follow(const State& before, State& x, double t)
{
    const double h = t - before.t;
    x.t = t;
    for (std::size_t b = 0; b < x.body.size(); ++b) {
        Motion& body = x.body[b];
        const Vec3 turn = h * body.omega_bar + 0.5 * h * h * body.omegadot_bar;
        if (!(turn.norm() <= largest_turn)) return model.body_name(static_cast<int>(b));
        body.r += h * body.rdot + 0.5 * h * h * body.rddot;
        body.A = body.A * lie::exp(turn);
    }
    const State predicted = x;
    lie::project_positions(model, K, x);
    lie::project_velocities(model, K, x);
    lie::solve_accelerations(model, K, x);
    for (std::size_t b = 0; b < x.body.size(); ++b) {
        const Motion &from = before.body[b], &expected = predicted.body[b], &found = x.body[b];
        const double path = std::abs(h) * (from.rdot.norm() + 0.5 * std::abs(h) * from.rddot.norm()),
                     turn =
                         std::abs(h) * (from.omega_bar.norm() + 0.5 * std::abs(h) * from.omegadot_bar.norm());
        const double r = (found.r - expected.r).norm(),
                     v = std::abs(h) * (found.rdot - from.rdot - h * from.rddot).norm(),
                     A = lie::log(expected.A.transpose() * found.A).norm(),
                     omega = std::abs(h) * (found.omega_bar - from.omega_bar - h * from.omegadot_bar).norm();
        if (!(std::max(r, v) <= relative_error * path + absolute_error * size) ||
            !(std::max(A, omega) <= relative_error * turn + absolute_error))
            return model.body_name(static_cast<int>(b));
    }
    return "";
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
