// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/leapfrog_step.hpp"

#include "lie/system.hpp"

#include <utility>

namespace hilda::lie {

LeapfrogStep::LeapfrogStep(const System& model, const Settings& settings, std::string name)
    : HalfImplicitStep(model, settings, std::move(name), 1, 1, ImplicitSprings::Rule::midpoint)
{}

void LeapfrogStep::fill_node(State& node, const State& after) const
{
    take_loads(node, after);
    for (int i = 0; i < bodies; ++i) {
        const Vec6 before = earlier(after.history, i), behind = later(after.history, i);
        node.body[i].rdot = 0.5 * (before + behind).head<3>();
        node.body[i].omega_bar = between(i, before.tail<3>(), behind.tail<3>(), after.t - node.t);
    }
    if (!springs.empty()) springs.restore_velocities(node, after.history, after.t - node.t);
}

Vec3 LeapfrogStep::half_kick_back(int i, double h) const
{
    return x_n.body[i].omega_bar - 0.5 * h * x_n.body[i].omegadot_bar;
}

Vec3 LeapfrogStep::between(int /*i*/, const Vec3& before, const Vec3& after, double /*h*/) const
{
    return 0.5 * (before + after);
}

void LeapfrogStep::begin(double h)
{
    if (x_n.history.size() == 0)
        start(h);
    else
        half_steps = x_n.history;
    extrapolate(at_node = x_n);
}

void LeapfrogStep::leave(State& x, double h)
{
    const int half = 6 * bodies;
    half_steps.tail(half) = half_steps.head(half);
    half_steps.head(half) = z.head(half) / h;
    x.history = half_steps;
    extrapolate(x);
}

LeapfrogStep::Vec6 LeapfrogStep::later(const Eigen::VectorXd& half_steps, int i) const
{
    return half_steps.segment<6>(6 * i);
}

LeapfrogStep::Vec6 LeapfrogStep::earlier(const Eigen::VectorXd& half_steps, int i) const
{
    return half_steps.segment<6>(6 * (bodies + i));
}

void LeapfrogStep::start(double h)
{
    if (springs.empty()) return half_kick(h);
    const std::vector<Motion> at_start = x_n.body;
    springs.start(x_n, h);
    springs.smooth_start(x_n);
    half_kick(h);
    x_n.body = at_start;
}

/// The history at a start
void LeapfrogStep::half_kick(double h)
{
    half_steps.resize(12 * bodies);
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x_n.body[i];
        half_steps.segment<6>(6 * i) << body.rdot - 0.5 * h * body.rddot, half_kick_back(i, h);
        half_steps.segment<6>(6 * (bodies + i)) << body.rdot - 1.5 * h * body.rddot,
            body.omega_bar - 1.5 * h * body.omegadot_bar;
    }
}

/// Velocities at the node for the evaluation of the loads, by linear extrapolation of the half-step
/// velocities
void LeapfrogStep::extrapolate(State& x) const
{
    for (int i = 0; i < bodies; ++i) {
        const Vec6 v = 1.5 * later(half_steps, i) - 0.5 * earlier(half_steps, i);
        x.body[i].rdot = v.head<3>();
        x.body[i].omega_bar = v.tail<3>();
    }
}

}  // namespace hilda::lie
