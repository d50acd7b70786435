// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/reference_solution.hpp"

#include "contact/evolving/unilateral.hpp"
#include "studies/exit_codes.hpp"
#include "studies/framework/pool.hpp"
#include "studies/running/diagnosis.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

constexpr double finer = 10;            // an rtol must be this many times smaller than those it judges
constexpr double coarsest_rtol = 1e-8;  // of a reference for integrators with a fixed step
constexpr double own_rtol = 1e-12;      // of a reference that chooses its own steps
constexpr double slack = 1 + 1e-9;      // 1e-11 is ten times smaller than 1e-10

}  // namespace

Reference::Reference(const std::string& kind, const StudyOptions& options, const Evaluated& evaluated)
    : options(options)
{
    const std::string study = "study " + kind + ": ";
    if (options.reference.empty()) {
        if (options.reference_step || options.reference_rtol)
            throw UsageError(study + "--reference-step and --reference-rtol are for --reference NAME");
        return;
    }
    scheme = &lie::scheme(options.reference);
    if (scheme->adaptive) {
        if (options.reference_step)
            throw UsageError(study + "the reference " + scheme->name +
                             " chooses its own steps: --reference-rtol, not --reference-step");
        rtol = options.reference_rtol.value_or(own_rtol);
        if (!options.force && evaluated.smallest_rtol > 0 && rtol * finer > evaluated.smallest_rtol * slack)
            throw UsageError(
                fmt::format("{}the reference {} at rtol {} is coarser than what it judges, which goes "
                            "down to rtol {}: it must be {} times smaller, or --force given",
                            study, scheme->name, step_text(rtol), step_text(evaluated.smallest_rtol), finer));
        if (!options.force && evaluated.smallest_step > 0 && rtol > coarsest_rtol * slack)
            throw UsageError(
                fmt::format("{}the reference {} at rtol {} is coarser than {}, at which it may judge "
                            "integrators with a fixed step: make it smaller, or give --force",
                            study, scheme->name, step_text(rtol), step_text(coarsest_rtol)));
        return;
    }
    if (options.reference_rtol)
        throw UsageError(study + "the reference " + scheme->name +
                         " has a fixed step: --reference-step, not --reference-rtol");
    if (!options.reference_step && !(evaluated.smallest_step > 0))
        throw UsageError(study + "the reference " + scheme->name +
                         " needs --reference-step: nothing that it judges has a fixed step");
    if (!options.force && scheme->order < evaluated.highest_order)
        throw UsageError(
            fmt::format("{}the reference {} is of order {}, lower than the {} of what it judges: choose "
                        "another, or give --force",
                        study, scheme->name, scheme->order, evaluated.highest_order));
    h = options.reference_step.value_or(evaluated.smallest_step / 10);
    if (!options.force && evaluated.smallest_step > 0 && !(h * slack < evaluated.smallest_step))
        throw UsageError(
            fmt::format("{}the reference {} at h = {} s is coarser than what it judges, which goes down "
                        "to h = {} s: its step must be smaller, or --force given",
                        study, scheme->name, step_text(h), step_text(evaluated.smallest_step)));
}

void Reference::evaluate(std::vector<Benchmark>& benchmarks) const
{
    const Pool pool(options.jobs, options.quiet ? "" : "truth", static_cast<long>(benchmarks.size()));
    pool.run([&](long k) { evaluate(benchmarks[k]); });
}

void Reference::evaluate(Benchmark& c) const
{
    if (scheme == nullptr) {
        dae::Description d = ready(c.problem, options);
        std::vector<double> times;
        for (long k = 0; k <= c.instants.count; ++k) times.push_back(static_cast<double>(k) * c.instants.dt);
        c.reference_solution = c.problem.reference_solution(d, times);
    } else {
        c.reference_solution = by_integrator(c);
        c.reference_name = scheme->adaptive ? fmt::format("{} at rtol {}", scheme->name, step_text(rtol))
                                            : fmt::format("{} at h = {:.6g} s", scheme->name, step(c));
    }
    for (const lie::State& x : c.reference_solution.row) dae::check_dropped_rows(*c.started->model, x);
    c.size = sizes(*c.started->model, c.reference_solution, c.instants, c.observable);
}

/// The one asked for, or by default the next smaller, that has a node at every instant
double Reference::step(const Benchmark& c) const
{
    const double wanted = h > 0 ? h : c.instants.dt, nodes = c.instants.dt / wanted;
    if (options.reference_step && std::abs(nodes - std::round(nodes)) > 1e-6)
        throw UsageError(
            fmt::format("--reference-step must divide the {:.6g} s between the instants of {}, got {}",
                        c.instants.dt, c.problem.name, wanted));
    return c.instants.dt / std::max(1., std::ceil(nodes - 1e-6));
}

lie::Trajectory Reference::by_integrator(const Benchmark& c) const
{
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-12);  // finer than theirs, whatever theirs is
    lie::TimeGrid grid{.h = c.instants.dt, .steps = c.instants.count};
    if (scheme->adaptive) {
        settings.rtol = rtol;
        settings.atol = 0;  // as rtol
    } else {
        grid.h = step(c);
        grid.interval = std::lround(c.instants.dt / grid.h);
        grid.steps = c.instants.count * grid.interval;
    }
    const auto integrator = contact::make_integrator(*c.started->model, *scheme, settings);
    return lie::march(c.started->x, *integrator, grid);
}

}  // namespace hilda::studies
