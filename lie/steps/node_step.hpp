// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the schemes whose result is complete at the node: velocities that satisfy the constraints,
/// and accelerations and multipliers from the saddle system at the node.

#pragma once

#include "lie/steps/saddle_step.hpp"

#include <limits>
#include <string>

namespace hilda::lie {

class NodeStep : public SaddleStep {
public:
    using SaddleStep::SaddleStep;

    void choose_pivots(const State& x, double h) override;

protected:
    /// Assembles K in the state x, unless K is already that of x.
    void assemble_once(const State& x);

    /// Sets r̈, ω̄̇, λ of x: K (r̈, ω̄̇, λ) = (F, τ̄, γ)                                Fang (2022), Eqs.
    /// 2.9, 2.17
    void set_accelerations(State& x);
    /// Replaces λ of x, which set_accelerations() has just set, by the multipliers of minimum norm, see
    /// Saddle::minimise_multipliers().
    void minimise_multipliers(State& x);

    /// The end of a step: projects the positions of x onto Φ = 0 by Newton steps with the present K, then the
    /// velocities onto Φ_r ṙ + Π̄ ω̄ = ν, and computes accelerations and multipliers.
    ///
    /// The corrections are the shortest in the metric of the mass. They are of the size of the local error,
    /// so that the order remains (Hairer, Lubich, Wanner 2006, Sec. IV.4). Returns the number of Newton
    /// steps.
    int finish(State& x, const std::string& scheme);

    // Parts of AdaptiveStep that a method with data beyond its stages replaces
    void begin_run() {}            ///< before the first step of a run
    void begin_internal_step() {}  ///< before the attempts of a step from x_n
    void accept_stages(double /*h*/) {}
    double most_growth() const { return std::numeric_limits<double>::infinity(); }  ///< of the next step
    /// The error that Newton's method has not reached in the last attempt, over the tolerance; 0: it has
    double unreached = 0;

private:
    bool assembled_at(const State& x) const;

    double shift_at = 0;  ///< the shift of K
    /// The state of K; t is NaN if there is none
    State at{.t = std::numeric_limits<double>::quiet_NaN(),
             .body = {},
             .alpha = {},
             .lambda = {},
             .discrete_state = {},
             .internal_state = {},
             .history = {},
             .applied_loads = {},
             .cone_forces = {}};
};

}  // namespace hilda::lie
