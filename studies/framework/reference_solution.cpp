// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/reference_solution.hpp"

#include "dae/kinematics.hpp"
#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "lie/settings.hpp"
#include "reference/solvers/index1.hpp"
#include "run/diagnosis.hpp"
#include "run/jobs/pool.hpp"
#include "run/simulation.hpp"
#include "run/watch/run_check.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

#include <limits>

namespace hilda::studies {

namespace {

constexpr double finer = 10;  // required ratio of the smallest rtol of the runs to that of the reference
constexpr double coarsest_rtol = 1e-8;  // of an adaptive reference for integrators with a fixed step
constexpr double own_rtol = 1e-12;      // default of an adaptive reference
constexpr double slack =
    1 + 1e-9;  // allows for rounding of decimal fractions: 1e-11 is ten times smaller than 1e-10

}  // namespace

Evaluated finest(const Schemes& schemes, double step, double rtol)
{
    Evaluated evaluated;
    for (const lie::Scheme* s : schemes)
        if (s->adaptive)
            evaluated.smallest_rtol = rtol;
        else
            evaluated.smallest_step = step,
            evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    return evaluated;
}

Reference::Reference(const StudyContext& context, const Evaluated& evaluated)
    : context(context), options(context.options), highest_order(evaluated.highest_order)
{
    if (options.reference.empty()) {
        h = evaluated.smallest_step / 10;
        if (options.reference_step || options.reference_rtol)
            context.refuse("--reference-step and --reference-rtol need --reference NAME");
        return;
    }
    scheme = &lie::scheme(options.reference);
    if (!options.reference_step) scheme = &scheme->with_adaptive_steps();
    if (scheme->adaptive) {
        if (options.reference_step)
            context.refuse("the reference " + scheme->name +
                           " chooses its own steps: use --reference-rtol instead of --reference-step");
        rtol = options.reference_rtol.value_or(own_rtol);
        if (!options.accept_reference && evaluated.smallest_rtol > 0 &&
            rtol * finer > evaluated.smallest_rtol * slack)
            context.refuse(fmt::format(
                "the reference {} at rtol {} is too coarse for runs with rtol {}: its rtol must be {} "
                "times smaller; --accept-reference accepts it",
                scheme->name, run::step_text(rtol), run::step_text(evaluated.smallest_rtol), finer));
        if (!options.accept_reference && evaluated.smallest_step > 0 && rtol > coarsest_rtol * slack)
            context.refuse(
                fmt::format("the reference {} at rtol {} is coarser than {}, the limit for runs with a fixed "
                            "step: reduce --reference-rtol; --accept-reference accepts it",
                            scheme->name, run::step_text(rtol), run::step_text(coarsest_rtol)));
        return;
    }
    if (options.reference_rtol)
        context.refuse("the reference " + scheme->name +
                       " has a fixed step: use --reference-step instead of --reference-rtol");
    if (!options.reference_step && !(evaluated.smallest_step > 0))
        context.refuse("the reference " + scheme->name +
                       " needs --reference-step, because no run of the study has a fixed step");
    if (!options.accept_reference && scheme->order < evaluated.highest_order)
        context.refuse(
            fmt::format("the reference {} has order {}, lower than order {} of a run: choose another "
                        "integrator; --accept-reference accepts it",
                        scheme->name, scheme->order, evaluated.highest_order));
    h = options.reference_step.value_or(evaluated.smallest_step / 10);
    if (!options.accept_reference && evaluated.smallest_step > 0 && !(h * slack < evaluated.smallest_step))
        context.refuse(
            fmt::format("the reference {} at h = {} s is coarser than a run at h = {} s: its step must be "
                        "smaller; --accept-reference accepts it",
                        scheme->name, run::step_text(h), run::step_text(evaluated.smallest_step)));
}

void Reference::evaluate(std::vector<Benchmark>& benchmarks, const std::vector<double>& steps) const
{
    for (const Benchmark& c : benchmarks)
        check_steps(context.name, c, steps, c.instants.dt * c.instants.stride);
    context.pool(benchmarks.size(), ", reference solution").run([&](long k) { evaluate(benchmarks[k]); });
}

void Reference::evaluate(Benchmark& c) const
{
    const lie::Scheme* const reference = scheme_for(c);
    if (reference == nullptr) {
        dae::Description d = read_and_start(c, options);
        std::vector<double> times;
        for (long k = 0; k <= c.instants.count; ++k) times.push_back(static_cast<double>(k) * c.instants.dt);
        c.reference_solution = c.problem.reference_solution(d, times);
    } else {
        c.reference_solution = by_integrator(c, *reference);
        c.reference_name = reference->adaptive
                               ? fmt::format("{} at rtol {}", reference->name, run::step_text(rtol))
                               : fmt::format("{} at h = {:.6g} s", reference->name, step(c));
        if (scheme == nullptr && !options.quiet)
            io::warning(fmt::format(
                "{}: {} exclude a reference solution with adaptive steps; the reference is {}; "
                "--reference selects another",
                c.problem.name,
                c.started->model->has_cones() ? "its rigid contacts" : "the internal states of its forces",
                c.reference_name));
    }
    for (const lie::State& x : c.reference_solution.row) dae::check_dropped_rows(*c.started->model, x);
    c.size = sizes(*c.started->model, c.reference_solution, c.instants, c.observable);
}

void Reference::estimate_errors(std::vector<Benchmark>& benchmarks) const
{
    context.pool(benchmarks.size(), ", error of the reference solution").run([&](long k) {
        Benchmark& c = benchmarks[k];
        std::vector<long> at;
        for (long row = 0; row <= c.instants.count; ++row) at.push_back(row);
        c.uncertainty =
            errors(*c.started->model, less_accurate(c), at, c.reference_solution, c.instants, c.observable);
    });
}

namespace {

/// A state that differs from x by rounding errors
lie::State disturbed(lie::State x)
{
    constexpr double eps = 2 * std::numeric_limits<double>::epsilon();
    for (lie::Motion& body : x.body) {
        body.A = body.A * lie::exp(lie::Vec3(eps, -eps, eps));
        body.rdot *= 1 + eps;
        body.omega_bar *= 1 - eps;
    }
    return x;
}

}  // namespace

lie::Trajectory Reference::less_accurate(const Benchmark& c) const
{
    constexpr double larger_tolerance = 10, larger_step = 2;
    if (const lie::Scheme* const reference = scheme_for(c); reference != nullptr)
        return by_integrator(c, *reference, reference->adaptive ? larger_tolerance : larger_step);
    const dae::Description d = read_and_start(c, options);
    if (6 * d.model->bodies() == d.model->rows()) {
        constexpr double substep = 2e-3;  // [s]
        dae::Kinematics kinematics(*d.model);
        lie::Trajectory run;
        lie::State x = d.x;
        for (const lie::State& row : c.reference_solution.row) {
            kinematics.move_to(x, row.t, substep);
            run.row.push_back(x);
        }
        return run;
    }
    // With a further instant in each interval its steps and its projections differ, and so do its rounding
    // errors.
    constexpr double further = 0.6;  // of an interval
    std::vector<double> times;
    for (const lie::State& row : c.reference_solution.row) {
        if (!times.empty()) times.push_back(times.back() + further * (row.t - times.back()));
        times.push_back(row.t);
    }
    const reference::OdeTolerance tolerance;
    const lie::Trajectory all =
        reference::index1(*d.model, disturbed(d.x), times,
                          {larger_tolerance * tolerance.relative, larger_tolerance * tolerance.absolute});
    lie::Trajectory run;
    for (size_t k = 0; k < all.row.size(); k += 2) run.row.push_back(all.row[k]);
    return run;
}

/// The integrator of the reference solution; nullptr: the reference solution of the problem
const lie::Scheme* Reference::scheme_for(const Benchmark& c) const
{
    if (scheme != nullptr || !c.problem.general_reference) return scheme;
    if (c.started->model->has_cones()) return &lie::scheme(run::default_integrator_of(*c.started->model));
    if (c.started->x.internal_state.empty()) return scheme;
    return &lie::scheme(highest_order > 2 ? "rA-rkmk-4" : "rA-half-1-momentum");
}

/// Step of the reference integrator [s], which divides the interval of the instants. The default is reduced
/// to such a step; io::UsageError if --reference-step is not one.
double Reference::step(const Benchmark& c) const
{
    double wanted = h > 0 ? h : c.instants.dt;
    // The scheme for rigid contacts is of first order, as those that it is compared with.
    if (c.started->model->has_cones() && scheme == nullptr) wanted /= 2;
    const double nodes = c.instants.dt / wanted;
    if (options.reference_step && std::abs(nodes - std::round(nodes)) > 1e-6)
        throw io::UsageError(
            fmt::format("--reference-step must divide the interval {:.6g} s of the instants of {}, got {}",
                        c.instants.dt, c.problem.name, wanted));
    return c.instants.dt / std::max(1., std::ceil(nodes - 1e-6));
}

lie::Trajectory Reference::by_integrator(const Benchmark& c, const lie::Scheme& reference,
                                         double coarser) const
{
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-12);  // not coarser than that of the runs
    lie::TimeGrid grid{.h = c.instants.dt, .steps = c.instants.count};
    if (reference.adaptive) {
        settings.rtol = coarser * rtol;
        settings.atol = 0;  // as rtol
    } else {
        grid.interval = std::max(1L, std::lround(c.instants.dt / (coarser * step(c))));
        grid.h = c.instants.dt / static_cast<double>(grid.interval);
        grid.steps = c.instants.count * grid.interval;
    }
    // The coarser solution, from which the error is estimated, may be unstable: the estimate is large then.
    const bool is_coarser = coarser > 1;
    try {
        run::Simulation simulation(
            {.model = *c.started->model,
             .start = c.started->x,
             .scheme = reference,
             .grid = grid,
             .settings = settings,
             .watch = is_coarser ? run::Watch::Action::record : run::Watch::Action::stop,
             .accept_unstable = is_coarser || options.accept_reference});
        lie::TrajectoryRecorder rows(simulation.grid());
        simulation.observe(rows);
        simulation.run().throw_failure();
        if (!is_coarser && !options.quiet)
            for (const run::Finding& found : simulation.findings_of_solution())
                io::warning(
                    fmt::format("the reference {} of {}: {}", reference.name, c.problem.name, found.text));
        return std::move(rows.trajectory);
    } catch (const io::UsageError& refused) {
        context.refuse("the reference " + reference.name + ": " + refused.what());
    }
}

}  // namespace hilda::studies
