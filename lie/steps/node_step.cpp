// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/node_step.hpp"

#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

namespace hilda::lie {

void NodeStep::choose_pivots(const State& x, double h)
{
    SaddleStep::choose_pivots(x, h);
    at = x;
}

void NodeStep::assemble_once(const State& x)
{
    if (assembled_at(x)) return;
    at.t = std::numeric_limits<double>::quiet_NaN();  // in case assemble() throws
    K.assemble(x);
    at = x;
    shift_at = K.used_shift();
}

void NodeStep::set_accelerations(State& x)
{
    assemble_once(x);
    solve_accelerations(model, K, x, loads, e);
}

int NodeStep::finish(State& x, const std::string& scheme)
{
    for (int k = 1; k <= most_iterations; ++k) {
        set_position_residual(model, K, x, e);
        K.solve(e);
        move(K, x, e);
        if (!converged(k, length_of_motion(e), K.constraint_part(e), 0)) continue;
        assemble_once(x);
        set_momenta(model, x, e);
        solve_velocities(model, K, x, e);
        set_accelerations(x);
        minimise_multipliers(x);
        return k;
    }
    no_convergence(scheme, correction, x);
}

void NodeStep::minimise_multipliers(State& x)
{
    if (!K.keeps_redundant_rows()) return;
    K.minimise_multipliers(e);
    x.lambda = K.constraint_part(e);
}

bool NodeStep::assembled_at(const State& x) const
{
    if (shift_at != K.used_shift()) return false;
    if (at.t != x.t || at.discrete_state != x.discrete_state || at.alpha != x.alpha) return false;
    for (size_t i = 0; i < x.body.size(); ++i)
        if (at.body[i].r != x.body[i].r || at.body[i].A != x.body[i].A) return false;
    return true;
}

}  // namespace hilda::lie
