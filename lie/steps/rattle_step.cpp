// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/rattle_step.hpp"

#include "lie/check.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace hilda::lie {

RattleStep::RattleStep(const System& model, const Settings& settings, std::string name)
    : NodeStep(model, settings), name(std::move(name)), loads_before(bodies), v(6 * bodies), dv(6 * bodies),
      anderson(K.size(), 6 * bodies), of_loads(6 * bodies, 6 * bodies),
      accelerates(model.pattern().algebraic.empty()), varies(!model.load_pattern().block.empty())
{}

Statistics RattleStep::statistics() const
{
    Statistics s = NodeStep::statistics();
    s.refactorizations -= repeated;
    return s;
}

int RattleStep::advance(State& x, double h, double t_end)
{
    K.set_shift(shift(h));
    assemble_at_start();
    set_known_part(h);
    predict(h, 0.5 * h * h, 0.5 * h * h);  // constant accelerations, and the multipliers of t_n
    x.t = t_end;
    anderson.start();
    for (int k = 1; k <= most_iterations; ++k) {
        place(x);
        set_linear_residual(K.rows());
        balance_momentum();
        set_constraint_residual(1, x, 1);
        K.solve(e);
        const bool ends = converged(k, length_of_motion(e), K.constraint_part(e), 1);
        if (!ends && k > patience && accelerates) anderson.accelerate(z, e);
        z += e;
        if (ends) {
            place(x);
            for (Motion& body : x.body) body.A = orthonormalised(body.A);
            set_velocities(x, h);
            set_accelerations(x);
            minimise_multipliers(x);
            return k;
        }
    }
    no_convergence(name, correction, x);
}

/// Assembles K(t_n). The step before has assembled it already, except before the first step of a run, where
/// its time differs by rounding, and for contacts, whose tangent vectors have changed when the node was
/// accepted. Not counted, so that a resumed run has the counts of an uninterrupted one.
void RattleStep::assemble_at_start()
{
    const long before = NodeStep::statistics().refactorizations;
    if (model.pattern().algebraic_variables() > 0)
        K.assemble(x_n);
    else
        assemble_once(x_n);
    repeated += NodeStep::statistics().refactorizations - before;
}

/// h M ṙ_n + ½h² F_n and h J̄ ω̄_n + ½h² n̄_n
void RattleStep::set_known_part(double h)
{
    model.loads(x_n, loads);
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x_n.body[i];
        b.segment<3>(6 * i) = h * mass.m[i] * body.rdot + 0.5 * h * h * loads.F[i];
        b.segment<3>(6 * i + 3) = h * (mass.J_bar[i] * body.omega_bar) + 0.5 * h * h * loads.n_bar[i];
    }
    K.constraint_part(b).setZero();
    K.algebraic_part(b).setZero();
}

/// The pose x at t_{n+1} from z
void RattleStep::place(State& x)
{
    place_increments(x);
    place_algebraic(x, 1);
}

/// The second half step: ṙ, ω̄ at t_{n+1}
void RattleStep::set_velocities(State& x, double h)
{
    for (int i = 0; i < bodies; ++i)
        v.segment<6>(6 * i) << 2 / h * z.segment<3>(6 * i) - x_n.body[i].rdot,
            2 / h * z.segment<3>(6 * i + 3) - x_n.body[i].omega_bar;
    lie::set_velocities(x, v);
    model.loads(x, loads);
    assemble_once(x);
    of_loads.start();
    constexpr int most = 50;
    double change = 0;
    for (int k = 1; k <= most; ++k) {
        for (int i = 0; i < bodies; ++i) {
            e.segment<3>(6 * i) = mass.m[i] / h * z.segment<3>(6 * i) + 0.5 * h * loads.F[i];
            e.segment<3>(6 * i + 3) = -momentum(i, -z.segment<3>(6 * i + 3)) / h + 0.5 * h * loads.n_bar[i];
        }
        solve_velocities(model, K, x, e);
        if (!varies || has_history(x)) return;
        for (int i = 0; i < bodies; ++i)
            dv.segment<6>(6 * i) << x.body[i].rdot - v.segment<3>(6 * i),
                x.body[i].omega_bar - v.segment<3>(6 * i + 3);
        const double before = std::exchange(change, dv.lpNorm<Eigen::Infinity>());
        const double rounding = 16 * std::numeric_limits<double>::epsilon() * v.lpNorm<Eigen::Infinity>();
        if (k > 1 && (change < rounding || settled(std::abs(h) * change, std::abs(h) * before))) return;
        of_loads.accelerate(v, dv);
        v += dv;
        lie::set_velocities(x, v);
        std::swap(loads, loads_before);
        model.loads(x, loads);
        // Loads that do not depend on velocities are those of the first evaluation.
        if (k == 1 && loads.F == loads_before.F && loads.n_bar == loads_before.n_bar) return;
    }
    std::ostringstream what;
    what.precision(2);
    what << name << ": the iteration for loads that depend on velocities does not converge (last change "
         << change << " m/s or rad/s after " << most << " evaluations); reduce the step";
    throw NumericalFailure("newton_diverged", what.str());
}

/// Whether the iteration of the loads ends: the change of a velocity times h is small compared with the
/// tolerance of Newton's method, or below it and no longer decreasing because of rounding errors of the
/// loads.
bool RattleStep::settled(double change, double before) const
{
    constexpr double share = 1e-4;
    return change <= share * settings.tolerance || (change < settings.tolerance && change > 0.5 * before);
}

}  // namespace hilda::lie
