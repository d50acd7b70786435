// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/node_step.hpp"

#include "lie/system.hpp"

namespace hilda::lie {

void NodeStep::choose_pivots(const State& x)
{
    K.choose_pivots(x);
    at = x;
}

void NodeStep::assemble_once(const State& x)
{
    if (assembled_at(x)) return;
    at.t = std::numeric_limits<double>::quiet_NaN();  // in case assemble() throws
    K.assemble(x);
    at = x;
}

void NodeStep::set_accelerations(State& x)
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

bool NodeStep::assembled_at(const State& x) const
{
    if (at.t != x.t || at.discrete_state != x.discrete_state || at.alpha != x.alpha) return false;
    for (size_t i = 0; i < x.body.size(); ++i)
        if (at.body[i].r != x.body[i].r || at.body[i].A != x.body[i].A) return false;
    return true;
}

}  // namespace hilda::lie
