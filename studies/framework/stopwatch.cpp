// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/stopwatch.hpp"

#include "contact/evolving/unilateral.hpp"

#include "dae/model_file.hpp"
#include "lie/settings.hpp"
#include "run/jobs/pool.hpp"
#include "run/simulation.hpp"
#include "studies/framework/table.hpp"

#include <algorithm>

namespace hilda::studies {

namespace {

constexpr double minimum_time = 0.02;  // of thread CPU time, far above the resolution of the clock [s]

}  // namespace

Spread spread(std::vector<double> values)
{
    if (values.empty()) return {.median = std::nan(""), .least = std::nan(""), .most = std::nan("")};
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    return {
        .median = (values[(n - 1) / 2] + values[n / 2]) / 2, .least = values.front(), .most = values.back()};
}

Spread TimedRun::microseconds() const
{
    const Spread s = seconds_of_repeats();
    const double factor = 1e6 / static_cast<double>(std::max(1L, statistics.steps));
    return {.median = factor * s.median, .least = factor * s.least, .most = factor * s.most};
}

double ratio(const TimedRun& a, const TimedRun& b)
{
    std::vector<double> of_each;
    for (size_t k = 0; k < std::min(a.repeat.size(), b.repeat.size()); ++k)
        of_each.push_back(a.repeat[k] / b.repeat[k]);
    return spread(of_each).median;
}

double seconds_of_march(const Run& run, const lie::Settings& of_study)
{
    const dae::Description& d = *run.c->started;
    const lie::Settings settings = settings_of(run, of_study);
    const lie::TimeGrid grid = lie::TimeGrid::over(run.c->end, run.h);
    double seconds = 0;
    long runs = 0;
    while (seconds < minimum_time) {
        const auto integrator = contact::make_integrator(
            *d.model, *run.scheme, settings);  // a new one, because it may store data of a run
        // The steps alone: a run::Simulation spends a part of its time on checks.
        lie::March march(d.x, *integrator, run.h);
        const double begin = run::thread_seconds();
        while (march.number() < grid.steps) march.advance({});
        seconds += run::thread_seconds() - begin;
        ++runs;
    }
    return seconds / static_cast<double>(runs);
}

void time_in_turn(const StudyContext& study, const std::vector<TimedRun*>& runs)
{
    const int repeats = study.repeats;
    const size_t count = runs.size();
    for (TimedRun* run : runs) run->repeat.assign(run->failed() ? 0 : repeats, 0);
    study.pool(count * repeats)
        .run(
            [&](long k) {
                TimedRun& run = *runs[k % count];
                if (!run.failed()) run.repeat[k / count] = seconds_of_march(run, study.settings);
            },
            [&](io::Archive& a, long k) {
                if (!runs[k % count]->failed()) a.value(runs[k % count]->repeat[k / count]);
            });
}

Exponent exponent(const std::vector<double>& x, const std::vector<double>& y)
{
    Exponent e{.fitted = fitted_order(x, y), .largest_local = std::nan("")};
    for (size_t k = 1; k < x.size(); ++k)
        e.largest_local = std::fmax(e.largest_local, order(x[k - 1], y[k - 1], x[k], y[k]));
    return e;
}

}  // namespace hilda::studies
