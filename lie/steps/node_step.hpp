// SPDX-License-Identifier: GPL-3.0-or-later
/// What schemes share that know a node in full when they reach it: velocities on their constraints, and
/// accelerations and multipliers from the saddle system there.

#pragma once

#include "lie/steps/newton_step.hpp"

#include <limits>

namespace hilda::lie {

class NodeStep : public SaddleStep {
public:
    using SaddleStep::SaddleStep;

    void choose_pivots(const State& x) override
    {
        K.choose_pivots(x);
        at = x;
    }

protected:
    /// K of this state, unless it is the one that K already holds
    void assemble_once(const State& x)
    {
        if (assembled_at(x)) return;
        at.t = std::numeric_limits<double>::quiet_NaN();  // K holds nothing if this throws
        K.assemble(x);
        at = x;
    }

    /// r̈, ω̄̇, λ of x: K (r̈, ω̄̇, λ) = (F, τ̄, γ)                                  Fang (2022), Eqs. 2.9, 2.17
    void set_accelerations(State& x)
    {
        assemble_once(x);
        model.loads(x, loads);
        for (int i = 0; i < model.bodies(); ++i) e.segment<6>(6 * i) << loads.F[i], tau_bar(i, x.body[i]);
        K.algebraic_part(e).setZero();
        model.gamma(x, K.constraint_part(e));
        K.solve(e);
        for (int i = 0; i < model.bodies(); ++i) {
            x.body[i].rddot = e.segment<3>(6 * i);
            x.body[i].omegadot_bar = e.segment<3>(6 * i + 3);
        }
        x.lambda = K.constraint_part(e);
    }

private:
    bool assembled_at(const State& x) const
    {
        if (at.t != x.t || at.discrete_state != x.discrete_state || at.alpha != x.alpha) return false;
        for (size_t i = 0; i < x.body.size(); ++i)
            if (at.body[i].r != x.body[i].r || at.body[i].A != x.body[i].A) return false;
        return true;
    }

    State at{.t = std::numeric_limits<double>::quiet_NaN(),
             .body = {},
             .alpha = {},
             .lambda = {},
             .discrete_state = {},
             .internal_state = {},
             .history = {}};
};

}  // namespace hilda::lie
