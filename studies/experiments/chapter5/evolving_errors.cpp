// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter5/evolving_errors.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"

#include <algorithm>

namespace hilda::studies {

ReferenceErrors::ReferenceErrors(const Benchmark& c, double h)
    : c(c), model(*c.started->model), h(h), contacts(run::evolving_contacts(model))
{}

void ReferenceErrors::accepted(const lie::State& x, long n, int)
{
    constraint_norm = std::max(constraint_norm, model.largest_residual(x).value);
    const double k = static_cast<double>(n) * h / c.instants.dt;
    const long nearest = std::lround(k);
    if (nearest > c.instants.count || std::abs(k - static_cast<double>(nearest)) > 1e-6) return;
    ++instants;
    const lie::State& reference_solution = c.reference_solution.row[nearest];
    const Difference d = difference(x, reference_solution);
    const auto update_maximum = [&](int norm, double e) {
        if (!(e <= error[norm])) error[norm] = e;
    };
    update_maximum(evolving_norm::r, d.r);
    update_maximum(evolving_norm::A, d.A);
    update_maximum(evolving_norm::alpha, (x.alpha - reference_solution.alpha).norm());
    for (const contact::EvolvingContact* contact : contacts)
        update_maximum(evolving_norm::F_N, std::abs(run::forces(model, *contact, x).F_N -
                                                    run::forces(model, *contact, reference_solution).F_N));
}

}  // namespace hilda::studies
