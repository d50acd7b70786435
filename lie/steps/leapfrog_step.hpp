// SPDX-License-Identifier: GPL-3.0-or-later
/// What the half-implicit schemes share that read their velocities half-way between nodes: the half kick backwards at a
/// start, velocities at the nodes, and what is carried from step to step.

#pragma once

#include "lie/steps/half_implicit_step.hpp"

namespace hilda::lie {

/// The state carries ṙ_{n-½}, ω̄_{n-½} of all bodies, then ṙ_{n-3/2}, ω̄_{n-3/2}.
class LeapfrogStep : public HalfImplicitStep {
public:
    bool keeps_history() const override { return true; }
    /// What the step found at t_n, and the velocities between those on both sides of it
    void fill_node(State& node, const State& after) const override
    {
        take_loads(node, after);
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec6 before = earlier(after.history, i), behind = later(after.history, i);
            node.body[i].rdot = 0.5 * (before + behind).head<3>();
            node.body[i].omega_bar = between(i, before.tail<3>(), behind.tail<3>(), after.t - node.t);
        }
    }

protected:
    LeapfrogStep(const System& model, const Settings& settings, std::string name)
        : HalfImplicitStep(model, settings, std::move(name), 1, 1)
    {}

    /// ω̄_{-½} of body i from what is known at t_0
    virtual Vec3 half_kick_back(int i, double h) const
    {
        return x_n.body[i].omega_bar - 0.5 * h * x_n.body[i].omegadot_bar;
    }
    /// ω̄ at a node from those half a step before and after it
    virtual Vec3 between(int /*i*/, const Vec3& before, const Vec3& after, double /*h*/) const
    {
        return 0.5 * (before + after);
    }

    void begin(double h) override
    {
        if (x_n.history.size() == 0)
            half_kick(h);
        else
            half_steps = x_n.history;
        extrapolate(at_node = x_n);
    }

    Vec6 velocity(int i) const override { return later(half_steps, i); }
    const State& node() const override { return at_node; }

    void place(State& x) const override
    {
        for (int i = 0; i < model.bodies(); ++i) {
            x.body[i].r = x_n.body[i].r + z.segment<3>(6 * i);
            x.body[i].A = x_n.body[i].A * exp(z.segment<3>(6 * i + 3));
        }
    }

    void leave(State& x, double h) override
    {
        const int half = 6 * model.bodies();
        half_steps.tail(half) = half_steps.head(half);
        half_steps.head(half) = z.head(half) / h;
        x.history = half_steps;
        extrapolate(x);
    }

private:
    /// (ṙ, ω̄) of body i half a step before the node, and one and a half
    Vec6 later(const Eigen::VectorXd& half_steps, int i) const { return half_steps.segment<6>(6 * i); }
    Vec6 earlier(const Eigen::VectorXd& half_steps, int i) const
    {
        return half_steps.segment<6>(6 * (model.bodies() + i));
    }

    void half_kick(double h)
    {
        half_steps.resize(12 * model.bodies());
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            half_steps.segment<6>(6 * i) << body.rdot - 0.5 * h * body.rddot, half_kick_back(i, h);
            half_steps.segment<6>(6 * (model.bodies() + i)) << body.rdot - 1.5 * h * body.rddot,
                body.omega_bar - 1.5 * h * body.omegadot_bar;
        }
    }

    /// ṙ, ω̄ at the node, for the loads there
    void extrapolate(State& x) const
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec6 v = 1.5 * later(half_steps, i) - 0.5 * earlier(half_steps, i);
            x.body[i].rdot = v.head<3>();
            x.body[i].omega_bar = v.tail<3>();
        }
    }

    State at_node;               ///< x_n with velocities at t_n
    Eigen::VectorXd half_steps;  ///< what the state carries
};

}  // namespace hilda::lie
