// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter3/work_runs.hpp"

#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hilda::studies {

namespace {

void compute(WorkRun& run, const lie::Settings& settings)
{
    Run& common = run;  // the part that the row and EvaluatedRun have in common
    EvaluatedRun evaluated{common};
    evaluate(evaluated, settings);
    common = static_cast<const Run&>(evaluated);
    run.errors = evaluated.errors;
}

}  // namespace

void WorkRun::transfer(io::Archive& a)
{
    Run::transfer(a);
    a.value(errors.value), a.value(errors.instants);
}

WorkGrid::WorkGrid(const StudyContext& study, const std::vector<std::string>& defaults,
                   const std::vector<double>& default_steps, const std::vector<double>& default_rtols)
    : schemes(study.schemes(defaults)), steps(study.steps(default_steps)),
      rtols(study.options.rtols.empty() ? default_rtols : study.options.rtols)
{
    for (const lie::Scheme*& scheme : schemes) scheme = &scheme->with_adaptive_steps();
}

Sweep<WorkRun> work_runs(const StudyContext& study, const WorkGrid& grid, const Reference& reference,
                         std::vector<Benchmark>& benchmarks)
{
    reference.evaluate(benchmarks, grid.finest().smallest_step > 0 ? grid.steps : std::vector<double>());
    Sweep<WorkRun> runs;
    for (const Benchmark& c : benchmarks)
        for (const lie::Scheme* scheme : grid.schemes)
            for (const double resolution : scheme->adaptive ? grid.rtols : grid.steps)
                // Only the nodes that the rms norms need: an adaptive scheme may have to end a step at each
                // node.
                runs.add(c, *scheme, scheme->adaptive ? c.instants.dt * c.instants.stride : resolution,
                         scheme->adaptive ? resolution : 0);
    runs.compute(
        study, [&](WorkRun& run) { compute(run, study.settings); }, ", errors");
    time_in_turn(study, runs);
    return runs;
}

Columns<WorkRun> columns_of_work()
{
    const auto error = [](int n) { return [n](const WorkRun& run) { return run.errors.value[n]; }; };
    Columns<WorkRun> norms{
        {"", "CPU [ms]", "{:.3f}", [](const auto& run) { return 1e3 * run.seconds_of_repeats().median; }}};
    for (int n = 0; n < norm::count; ++n)
        norms = norms + Columns<WorkRun>{{norm::names[n],
                                          n == norm::r   ? "r [m]"
                                          : n == norm::v ? "v [m/s]"
                                                         : norm::names[n],
                                          error(n)}};
    return norms + Columns<WorkRun>{
                       Column<WorkRun>(column::steps).as("steps", "{:.0f}"),
                       column::iterations,
                       column::factorizations,
                       column::refactorizations,
                       column::cpu_seconds_of_repeats,
                       {"cpu_seconds_min", [](const auto& run) { return run.seconds_of_repeats().least; }},
                       {"cpu_seconds_max", [](const auto& run) { return run.seconds_of_repeats().most; }},
                       column::status};
}

WorkNeeded work_needed(const WorkSeries& series, double accuracy)
{
    std::vector<double> e, seconds;
    for (const WorkRun* run : series)
        e.push_back(run->errors.value[norm::r]), seconds.push_back(run->seconds_of_repeats().median);
    return work_needed(e, seconds, accuracy);
}

std::string milliseconds(const WorkNeeded& work, int digits)
{
    if (std::isnan(work.seconds)) return "-";
    return fmt::format("{}{:.{}f}", work.at_most ? "<= " : "", 1e3 * work.seconds, digits);
}

}  // namespace hilda::studies
