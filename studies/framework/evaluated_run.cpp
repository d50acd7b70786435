// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/evaluated_run.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "lie/settings.hpp"

#include <algorithm>

namespace hilda::studies {

void AtInstants::accepted(const lie::State& x, long n, int)
{
    dae::check_dropped_rows(model, x);
    const double k = static_cast<double>(n) * h / instants.dt;
    const long nearest = std::lround(k);
    if (nearest > instants.count || std::abs(k - static_cast<double>(nearest)) > 1e-6) return;
    at.push_back(nearest);
    run.row.push_back(x);
    constraint_norm = std::max(constraint_norm, model.largest_residual(x).value);
    for (const lie::Motion& body : x.body)
        orthogonality = std::max(orthogonality, lie::orthogonality_error(body.A));
}

void evaluate(EvaluatedRun& run, const lie::Settings& of_study)
{
    const dae::Model& model = *run.c->started->model;
    AtInstants nodes(model, run.c->instants, run.h);
    lie::Observer* observers[] = {&nodes};
    march(run, of_study, observers);
    run.constraint_norm = nodes.constraint_norm;
    run.orthogonality = nodes.orthogonality;
    if (run.failed())
        run.errors.value.fill(std::nan(""));
    else
        run.errors =
            errors(model, nodes.run, nodes.at, run.c->reference_solution, run.c->instants, run.c->observable);
    run.nodes = std::move(nodes.run);
    run.at = std::move(nodes.at);
}

Errors difference(const EvaluatedRun& a, const EvaluatedRun& b)
{
    lie::Trajectory as_reference;
    as_reference.row.resize(static_cast<size_t>(a.c->instants.count + 1));
    for (size_t k = 0; k < b.at.size(); ++k) as_reference.row[b.at[k]] = b.nodes.row[k];
    return errors(*a.c->started->model, a.nodes, a.at, as_reference, a.c->instants, a.c->observable);
}

}  // namespace hilda::studies
