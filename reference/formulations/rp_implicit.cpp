// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/formulations/rp_implicit.hpp"

#include "lie/system.hpp"

#include <cmath>
#include <utility>

namespace hilda::reference {

RpImplicit::RpImplicit(const lie::System& model, const lie::Settings& settings, std::string name)
    : NewtonStep(model, settings), name(std::move(name)), equations(model), q_n(7 * model.bodies()),
      qdot_n(q_n.size()), qddot_n(q_n.size())
{
    formula.q = formula.qdot = q_n;
    z.resize(equations.size()), e.resize(equations.size());
}

lie::Statistics RpImplicit::statistics() const { return statistics_with(equations.N); }

int RpImplicit::step(lie::State& x, double h)
{
    x_n = x;
    Attempt attempt(x, x_n);
    const bool at_start = x_n.history.size() != 8 * model.bodies() + more();
    restore(at_start);
    set_formula(h, at_start);
    predict();
    x.t = x_n.t + h;
    for (int k = 1; k <= settings.max_iterations; ++k) {
        equations.place(formula, z, x);
        equations.residual(formula, z, x, e);
        equations.assemble(formula, z, x);
        equations.N.factor();
        equations.N.solve(e);
        z -= e;
        if (converged(k, h * h * length_of_motion(e), e.segment(equations.at_lambda(), model.rows()),
                      h * h)) {
            equations.place(formula, z, x);
            save_step(x, h);
            return done(attempt, k);
        }
    }
    no_convergence(name, correction, x);
}

void RpImplicit::set_linear_acceleration(double h)
{
    formula.qdot = qdot_n + h / 2 * qddot_n;
    formula.q = q_n + h * qdot_n + h * h / 3 * qddot_n;
    formula.g_v = h / 2, formula.g_q = h * h / 6;
}

/// Sets q_n and q̇_n from x_n and its history, and q̈_n with p̈ from ω̄̇.
void RpImplicit::restore(bool at_start)
{
    for (int i = 0; i < model.bodies(); ++i) {
        const lie::Motion& body = x_n.body[i];
        EulerParameters p;
        lie::Vec4 pdot;
        if (at_start)
            p = EulerParameters(body.A), pdot = p.qdot(body.omega_bar);
        else
            p.q = x_n.history.segment<4>(8 * i), pdot = x_n.history.segment<4>(8 * i + 4);
        q_n.segment<7>(7 * i) << body.r, p.q;
        qdot_n.segment<7>(7 * i) << body.rdot, pdot;
        qddot_n.segment<7>(7 * i) << body.rddot, p.qddot(pdot, body.omegadot_bar);
    }
}

/// Initial guess: the accelerations and multipliers of t_n
void RpImplicit::predict() { z << qddot_n, x_n.lambda, Eigen::VectorXd::Zero(model.bodies()); }

/// Norm of the correction in (r̈, ω̄̇). |ω̄̇| = 2 |p̈|, so the squares of p̈ have the weight 4.
double RpImplicit::length_of_motion(const Eigen::VectorXd& dz) const
{
    double sum = dz.head(7 * model.bodies()).squaredNorm();
    for (int i = 0; i < model.bodies(); ++i) sum += 3 * dz.segment<4>(7 * i + 3).squaredNorm();
    return std::sqrt(sum);
}

void RpImplicit::save_step(lie::State& x, double h)
{
    const int bodies = model.bodies();
    x.history.resize(8 * bodies + more());
    for (int i = 0; i < bodies; ++i)
        x.history.segment<8>(8 * i) << equations.p(i).normalized(), equations.pdot(i);
    save_more(h, x.history.tail(more()));
}

}  // namespace hilda::reference
