// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/tree_step.hpp"

#include "lie/check.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/system.hpp"

namespace hilda::lie {

TreeStep::TreeStep(const System& model, const Settings& settings)
    : NodeStep(model, settings), coordinates(model.tree()), articulated(mass, model.tree()),
      freedoms(coordinates.freedoms()), of_bodies(12 * bodies)
{
    if (!model.tree().refusal.empty()) throw InvalidInput(model.tree().refusal);
    for (Eigen::VectorXd* v : {&w_n, &u, &w, &wdot}) v->setZero(freedoms);
}

void TreeStep::begin_stages()
{
    coordinates.start(x_n, w_n, wdot);
    u.setZero();
    w = w_n;
}

void TreeStep::set_slope(const State& /*x*/, Eigen::Ref<Eigen::VectorXd> slope) const
{
    coordinates.set_rates(u, w, slope.head(freedoms));
    slope.tail(freedoms) = wdot;
}

void TreeStep::place(State& x, const Eigen::VectorXd& d)
{
    u = d.head(freedoms);
    w = w_n + d.tail(freedoms);
    coordinates.place(u, w, x);
}

double TreeStep::square_over(const Eigen::VectorXd& tolerance, const Eigen::VectorXd& error)
{
    coordinates.spread(error.head(freedoms), 0, of_bodies);
    coordinates.spread(error.tail(freedoms), 6, of_bodies);
    return of_bodies.cwiseQuotient(tolerance).squaredNorm();
}

void TreeStep::set_accelerations(State& x)
{
    model.loads(x, loads);
    articulated.solve(x, loads, wdot);
    if (!wdot.allFinite()) throw NonFinite("the accelerations of the joints are not finite");
}

int TreeStep::finish(State& x, const std::string& /*scheme*/)
{
    set_accelerations(x);
    if (settings.multipliers) set_multipliers(x);
    return 0;
}

/// λ from K (r̈, ω̄̇, λ) = (F, τ̄, γ)
void TreeStep::set_multipliers(State& node)
{
    if (model.rows() == 0) return;
    NodeStep::assemble_once(node);
    set_load_terms(model, K, node, loads, e);
    K.solve_in_step(e);
    node.lambda = K.constraint_part(e);
}

}  // namespace hilda::lie
