// SPDX-License-Identifier: GPL-3.0-or-later
/// CPU time per step of the N-bar pendulum over N (Fang 2022, Fig. 3.15).
///
/// N bars are connected by spherical joints. The gravity vector is inclined, and each bar initially spins
/// about its longitudinal axis at a random rate (--seed); the bars have no other velocity. For each N and
/// scheme: thread CPU time per step (median of the repeats), its ratio to rA-full-1, and the exponent p of
/// time ~ N^p, fitted for N >= 64.

#include "dae/model_file.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/study_options.hpp"
#include "studies/problems/n_pendulum.hpp"

#include <fmt/format.h>

#include <chrono>

namespace hilda::studies {

namespace {

const std::string baseline = "rA-full-1";
constexpr int fit_from = 64;  // smallest N of the fit; below, the costs independent of N matter

struct ScalingRun : TimedRun {
    int N = 0;
    double start_seconds = 0;  ///< wall time to read the model and find its start [s]

    void transfer(io::Archive& a)
    {
        TimedRun::transfer(a);
        a.value(start_seconds);
    }
};

/// A benchmark with N bars, and the wall time to read the model and find its start [s]
struct Chain {
    int N = 0;
    Benchmark benchmark = {};
    double start_seconds = 0;
};

std::vector<Chain> chains(const StudyContext& s)
{
    std::vector<Chain> all;
    for (const int N : s.options.bars.empty() ? std::vector<int>{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024}
                                              : s.options.bars)
        all.push_back({.N = N});
    const auto end = [](const dae::Description&) { return 0.1; };
    s.pool(all.size(), ", reading models").run([&](long k) {
        Chain& chain = all[static_cast<size_t>(k)];
        const auto begin = std::chrono::steady_clock::now();
        chain.benchmark = make_benchmark(spinning_n_pendulum(chain.N, s.options.seed), s.options, end);
        chain.start_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    });
    return all;
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

/// The exponents, and the mean over N of the time ratio (52 % in the dissertation)
void print_fits(const std::vector<ScalingRun>& runs, const Schemes& schemes, StudyText& out)
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

void scaling(StudyContext& s)
{
    if (!s.problems.empty())
        s.refuse("the model is the N-bar pendulum and --problem is not accepted; set N by --bars N1,N2,...");
    const std::uint64_t seed = s.options.seed;
    const double h = s.one_step(1e-3);
    const Schemes schemes = s.fixed_step_schemes({"rA-half-1", "rA-full-1", "rA-half-1-kick", "rA-half-2"});
    const std::vector<Chain> all = chains(s);
    Sweep<ScalingRun> runs;
    double longest_start = 0;
    for (const Chain& chain : all) {
        check_steps(s.name, chain.benchmark, {h});
        longest_start = std::max(longest_start, chain.start_seconds);
        for (const lie::Scheme* scheme : schemes) {
            ScalingRun& run = runs.add(chain.benchmark, *scheme, h);
            run.N = chain.N, run.start_seconds = chain.start_seconds;
        }
    }
    runs.compute(
        s, [&](ScalingRun& run) { march(run, s.settings); }, ", first runs");
    time_in_turn(s, runs);
    set_ratios(runs, baseline);

    const Columns<ScalingRun> columns =
        Columns<ScalingRun>{
            column::problem,
            {"bars", "N", "{:.0f}", &ScalingRun::N},
            column::integrator,
            column::h,
            column::steps,
            column::iterations,
            column::factorizations,
            column::refactorizations,
            {"", "us/step/N", "{:.3f}", [](const auto& run) { return run.microseconds().median / run.N; }}} +
        columns_of_times<ScalingRun>(baseline, "{:.2f}") +
        Columns<ScalingRun>{{"start_seconds", &ScalingRun::start_seconds}, column::status};
    s.text << fmt::format(
        "\nN-bar pendulum, h = {:g} s, end time {:g} s, seed {}: thread CPU time per step\n", h,
        all.front().benchmark.end, seed);
    columns.print(s.text, runs,
                  {"bars", "integrator", "us_per_step", "us_per_step_min", "us_per_step_max", "us/step/N",
                   "iterations_per_step", "ratio_to_full", "status"});
    print_fits(runs, schemes, s.text);
    s.text << fmt::format(
        "\nmedian, min and max of {} repeats; parallel runs: {}; longest time to read a model and find its "
        "start: {:.2f} s\n",
        s.repeats, s.jobs_at_once, longest_start);
    s.json["runs"] = columns.array(runs, {"bars", "us_per_step", "us_per_step_min", "us_per_step_max",
                                          "ratio_to_full", "iterations_per_step", "start_seconds"});
    s.figures = {"scaling.png"};
    for (const lie::Scheme* scheme : schemes) {
        const Exponent p = exponent_of(runs, scheme);
        s.measured.push_back(
            {.of = scheme->name, .value = {{"exponent", p.fitted}, {"largest_exponent", p.largest_local}}});
        s.json["exponents"][scheme->name] = {{"fitted", p.fitted}, {"largest_local", p.largest_local}};
    }
    s.table = columns.csv(runs);
    s.end_of_runs(run_pointers(runs));
    for (const ScalingRun& run : runs)
        if (run.scheme->name != baseline)
            s.measured.push_back({.of = run.name(), .value = {{"ratio_to_full", run.ratio}}});
    if (s.check) s.evaluate(criteria_of_times(runs));
}

const bool registered_scaling = io::Registry<Study>::add(
    {.name = "scaling",
     .answers = "CPU time per step of the N-bar pendulum over N (Fig. 3.15)",
     .options = options_of_integrators({"--repeats", "--bars", "--check", "--seed", "--strict"}),
     .keys = {"exponent", "largest_exponent", "ratio_to_full"},
     .files = {"scaling.png"},
     .run = scaling});

}  // namespace

}  // namespace hilda::studies
