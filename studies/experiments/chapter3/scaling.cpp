// SPDX-License-Identifier: GPL-3.0-or-later
/// CPU time per step of the N-bar pendulum over N (Fang 2022, Figs. 3.14, 3.15).
///
/// N bars are connected by spherical joints. The gravity vector is inclined, and each bar initially spins
/// about its longitudinal axis at a random rate (--seed); the bars have no other velocity. For each N and
/// scheme: thread CPU time per step (median of the repeats), its ratio to rA-full-1, and the exponent p of
/// time ~ N^p, fitted for N >= 64.

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/problems/n_pendulum.hpp"

#include <fmt/format.h>

#include <chrono>

namespace hilda::studies {

namespace {

const std::string kind = "scaling";
const std::string baseline = "rA-full-1";
constexpr int fit_from = 64;  // smallest N of the fit; below, the costs independent of N matter

struct ScalingRun : TimedRun {
    int N = 0;
    double start_seconds = 0;     ///< wall time to read the model and find its start [s]
    double ratio = std::nan("");  ///< of the time per step to that of rA-full-1
};

struct ChainBenchmarks {
    std::vector<int> N;
    std::vector<Benchmark> all;
    std::vector<double> start_seconds;
};

ChainBenchmarks chains(const StudyOptions& options)
{
    ChainBenchmarks chains;
    chains.N =
        options.bars.empty() ? std::vector<int>{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024} : options.bars;
    chains.all.resize(chains.N.size());
    chains.start_seconds.resize(chains.N.size());
    const auto end = [](const dae::Description&) { return 0.1; };
    Pool(options.jobs, options.quiet ? "" : "reading models", static_cast<long>(chains.N.size()))
        .run([&](long k) {
            const auto begin = std::chrono::steady_clock::now();
            chains.all[k] = make_benchmark(spinning_n_pendulum(chains.N[k], options.seed), options, end);
            chains.start_seconds[k] =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        });
    return chains;
}

/// Exponent of the time per step over N of one scheme, N >= fit_from
Exponent exponent_of(const std::vector<ScalingRun>& runs, const lie::Scheme* scheme)
{
    std::vector<double> N, seconds;
    for (const ScalingRun& run : runs)
        if (run.scheme == scheme && run.N >= fit_from && !run.failed()) {
            N.push_back(run.N);
            seconds.push_back(run.microseconds().median);
        }
    return exponent(N, seconds);
}

Table as_table(const std::vector<ScalingRun>& runs)
{
    Table table({{"problem"},
                 {"bars"},
                 {"integrator"},
                 {"h"},
                 {"steps"},
                 {"iterations_per_step"},
                 {"factorizations"},
                 {"refactorizations"},
                 {"us_per_step"},
                 {"us_per_step_min"},
                 {"us_per_step_max"},
                 {"ratio_to_full"},
                 {"start_seconds"},
                 {"status"}});
    for (const ScalingRun& run : runs)
        table.add({run.c->problem.name, static_cast<double>(run.N), run.scheme->name, run.h,
                   static_cast<double>(run.statistics.steps), run.statistics.iterations_per_step(),
                   static_cast<double>(run.statistics.factorizations),
                   static_cast<double>(run.statistics.refactorizations), run.microseconds().median,
                   run.microseconds().least, run.microseconds().most, run.ratio, run.start_seconds,
                   run.status});
    return table;
}

void print(const std::vector<ScalingRun>& runs, const StudyOptions& options, std::ostream& out)
{
    Table table({{"N", "{:.0f}"},
                 {"integrator"},
                 {"us/step", "{:.2f}"},
                 {"min", "{:.2f}"},
                 {"max", "{:.2f}"},
                 {"us/step/N", "{:.3f}"},
                 {"iter", "{:.2f}"},
                 {"time / " + baseline, "{:.3f}"},
                 {"status"}});
    for (const ScalingRun& run : runs)
        table.add({static_cast<double>(run.N), run.scheme->name, run.microseconds().median,
                   run.microseconds().least, run.microseconds().most, run.microseconds().median / run.N,
                   run.statistics.iterations_per_step(), run.ratio, run.status});
    const ScalingRun& first = runs.front();
    out << fmt::format("\nN-bar pendulum, h = {:g} s, end time {:g} s, seed {}: thread CPU time per step\n",
                       first.h, first.c->end, options.seed);
    table.print(out);
}

/// The exponents, and the mean over N of the time ratio (52 % in the dissertation)
void print_fits(const std::vector<ScalingRun>& runs, const Schemes& schemes, std::ostream& out)
{
    Table table({{"integrator"},
                 {fmt::format("exponent, N >= {}", fit_from), "{:.3f}"},
                 {"largest local exponent", "{:.3f}"},
                 {"mean time / " + baseline, "{:.3f}"}});
    for (const lie::Scheme* s : schemes) {
        double sum = 0;
        int count = 0;
        for (const ScalingRun& run : runs)
            if (run.scheme == s && !std::isnan(run.ratio)) sum += run.ratio, ++count;
        const Exponent p = exponent_of(runs, s);
        table.add({s->name, p.fitted, p.largest_local, count > 0 ? sum / count : std::nan("")});
    }
    out << '\n';
    table.print(out);
}

io::Json as_json(const std::vector<ScalingRun>& runs)
{
    io::Json rows = io::Json::array();
    for (const ScalingRun& run : runs) {
        io::Json row = as_json(static_cast<const Run&>(run));
        row.update({{"bars", run.N},
                    {"us_per_step", run.microseconds().median},
                    {"us_per_step_min", run.microseconds().least},
                    {"us_per_step_max", run.microseconds().most},
                    {"ratio_to_full", run.ratio},
                    {"iterations_per_step", run.statistics.iterations_per_step()},
                    {"start_seconds", run.start_seconds}});
        rows.push_back(row);
    }
    return rows;
}

int scaling(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"exponent", "largest_exponent", "ratio_to_full"});
    if (!options.problems.empty())
        throw io::UsageError(
            "study scaling: the model is the N-bar pendulum and --problem is not accepted; set N by --bars "
            "N1,N2,...");
    const double h = one_step(kind, options, 1e-3);
    const Schemes schemes =
        fixed_step_schemes(kind, options, {"rA-half-1", "rA-full-1", "rA-half-1-kick", "rA-half-2"});
    const ChainBenchmarks chain = chains(options);
    std::vector<ScalingRun> runs;
    for (size_t k = 0; k < chain.N.size(); ++k) {
        check_steps(kind, chain.all[k], {h});
        for (const lie::Scheme* s : schemes) {
            ScalingRun run;
            run.c = &chain.all[k], run.scheme = s, run.h = h, run.N = chain.N[k];
            run.start_seconds = chain.start_seconds[k];
            runs.push_back(run);
        }
    }
    Pool(options.jobs, options.quiet ? "" : kind + ", first runs", static_cast<long>(runs.size()))
        .run([&](long k) { march(runs[k], options.settings); });
    const auto timed = pointers<TimedRun*>(runs);
    time_in_turn(kind, options, timed, [&](long) { return options.settings; });
    for (ScalingRun& run : runs)
        for (const ScalingRun& baseline_run : runs)
            if (baseline_run.N == run.N && baseline_run.scheme->name == baseline)
                run.ratio = studies::ratio(run, baseline_run);

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"runs", as_json(runs)}}};
    output.figures = {"scaling.png"};
    print(runs, options, output.text);
    print_fits(runs, schemes, output.text);
    output.text << fmt::format(
        "\nmedian, min and max of {} repeats; parallel runs: {}; longest time to read a model and find its "
        "start: {:.2f} s\n",
        options.repeats, options.jobs,
        *std::max_element(chain.start_seconds.begin(), chain.start_seconds.end()));
    std::vector<Measured> measurements;
    io::Json exponents = io::Json::object();
    for (const lie::Scheme* s : schemes) {
        const Exponent p = exponent_of(runs, s);
        measurements.push_back(
            {.of = s->name, .value = {{"exponent", p.fitted}, {"largest_exponent", p.largest_local}}});
        exponents[s->name] = {{"fitted", p.fitted}, {"largest_local", p.largest_local}};
    }
    output.json["exponents"] = exponents;
    for (const ScalingRun& run : runs)
        if (run.scheme->name != baseline)
            measurements.push_back({.of = run.name(), .value = {{"ratio_to_full", run.ratio}}});
    return finish(options, output, run_pointers(runs), measurements);
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "CPU time per step of the N-bar pendulum over N (Figs. 3.14, 3.15)",
                         .accepted = takes::repeats | takes::bars,
                         .run = scaling});

}  // namespace

}  // namespace hilda::studies
