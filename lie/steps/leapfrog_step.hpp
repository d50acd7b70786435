// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the half-implicit schemes whose velocities belong to the middle of a step: the half step
/// backwards at a start, the velocities at the nodes, and the history of half-step velocities.

#pragma once

#include "lie/steps/half_implicit_step.hpp"

namespace hilda::lie {

/// State::history holds (ṙ, ω̄) at t_{n-1/2} of all bodies, then (ṙ, ω̄) at t_{n-3/2}.
class LeapfrogStep : public HalfImplicitStep {
public:
    bool keeps_history() const override { return true; }
    /// Sets the loads at t_n, and the velocities at t_n from those half a step before and after it.
    void fill_node(State& node, const State& after) const override;

protected:
    LeapfrogStep(const System& model, const Settings& settings, std::string name);

    /// ω̄ of body i at t_{-1/2}, from the state at t_0
    virtual Vec3 half_kick_back(int i, double h) const;
    /// ω̄ of body i at a node, from ω̄ half a step before and after it
    virtual Vec3 between(int i, const Vec3& before, const Vec3& after, double h) const;

    void begin(double h) override;
    Vec6 velocity(int i) const override { return later(half_steps, i); }
    const State& node() const override { return at_node; }
    void leave(State& x, double h) override;

private:
    /// (ṙ, ω̄) of body i half a step before the node
    Vec6 later(const Eigen::VectorXd& half_steps, int i) const;
    /// (ṙ, ω̄) of body i one and a half steps before the node
    Vec6 earlier(const Eigen::VectorXd& half_steps, int i) const;
    void start(double h);
    void half_kick(double h);
    void extrapolate(State& x) const;

    State at_node;               ///< x_n with velocities at t_n
    Eigen::VectorXd half_steps;  ///< the history
};

}  // namespace hilda::lie
