// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/backward_euler_step.hpp"

#include "lie/system.hpp"

#include <utility>

namespace hilda::lie {

BackwardEulerStep::BackwardEulerStep(const System& model, const Settings& settings, std::string name)
    : NewtonStep(model, settings), C(model.pattern()), name(std::move(name))
{
    z.resize(6 * bodies + model.rows() + C.algebraic_variables());
    e.resize(z.size());
    if (model.keeps_redundant_rows()) of_multipliers = std::make_unique<Saddle>(model);
}

int BackwardEulerStep::step(State& x, double h)
{
    x_n = x;
    Attempt attempt(x, x_n);
    begin(h);
    predict(0, 1, 1);
    start_redundant();
    x.t = x_n.t + h;
    for (int k = 1; k <= most_iterations; ++k) {
        place(x, h);
        set_residual(x, h);
        solve(x, h);
        z -= e;
        if (converged(k, h * h * length_of_motion(e), constraint_part(e), h * h)) {
            place(x, h);
            refuse_whole_turns(x, h, name);
            for (Motion& body : x.body) body.A = orthonormalised(body.A);
            if (of_multipliers) {
                of_multipliers->assemble(x);
                of_multipliers->minimise_multipliers(z);
                x.lambda = constraint_part(z);
            }
            return done(attempt, k);
        }
    }
    no_convergence(name, correction, x);
}

/// The state x at t_{n+1} from z (Eq. 3.19)
void BackwardEulerStep::place(State& x, double h) const
{
    for (int i = 0; i < bodies; ++i) {
        const Motion& from = x_n.body[i];
        Motion& body = x.body[i];
        body.rddot = z.segment<3>(6 * i);
        body.omegadot_bar = z.segment<3>(6 * i + 3);
        body.rdot = from.rdot + h * body.rddot;
        body.omega_bar = from.omega_bar + h * body.omegadot_bar;
        body.r = from.r + h * body.rdot;
        body.A = from.A * exp(h * body.omega_bar);
    }
    place_algebraic(x, h * h);
    x.lambda = z.segment(6 * bodies, model.rows());
}

/// The residual e in the state x (Eq. 3.20)
void BackwardEulerStep::set_residual(const State& x, double h)
{
    set_motion_residual(x, C);
    model.phi(x, constraint_part(e));
    constraint_part(e) /= h * h;
}

}  // namespace hilda::lie
