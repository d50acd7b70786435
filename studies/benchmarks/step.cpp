// SPDX-License-Identifier: GPL-3.0-or-later
/// Time of a whole step (loads, constraints, factorization, Newton, update) of the N-bar pendulum, over N.
///
///     cmake --preset native && cmake --build --preset native --target hilda_benchmarks
///     build/native/studies/hilda_benchmarks

#include "lie/integrator.hpp"
#include "studies/problem.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace hilda;

void step(benchmark::State& timer, const char* scheme)
{
    dae::Description d =
        dae::read_model(studies::problem("n_pendulum_" + std::to_string(timer.range(0))).model, "n_pendulum");
    dae::start(d);
    const auto integrator = lie::scheme(scheme).make(*d.model, {});
    lie::State x = d.x;
    for (auto _ : timer) {
        integrator->step(x, 1e-3);
        if (x.t > 1) {  // the same second of motion again and again, so that every run does the same work
            timer.PauseTiming();
            x = d.x;
            timer.ResumeTiming();
        }
    }
    const lie::Statistics statistics = integrator->statistics();
    timer.counters["iterations_per_step"] =
        static_cast<double>(statistics.iterations) / static_cast<double>(statistics.steps);
}

BENCHMARK_CAPTURE(step, half_1, "rA-half-1")
    ->Arg(2)
    ->Arg(8)
    ->Arg(32)
    ->Arg(128)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, half_2, "rA-half-2")
    ->Arg(2)
    ->Arg(8)
    ->Arg(32)
    ->Arg(128)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, full_1, "rA-full-1")
    ->Arg(2)
    ->Arg(8)
    ->Arg(32)
    ->Arg(128)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
