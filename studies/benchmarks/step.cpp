// SPDX-License-Identifier: GPL-3.0-or-later
/// Time of a complete step (loads, constraints, factorisation, Newton iteration, update) of the N-bar
/// pendulum and of a chain of N hinges over N, for all fixed-step schemes and both linear solvers, at
/// h = 1e-3 s.
///
///     cmake --preset native && cmake --build --preset native --target hilda_benchmarks
///     build/native/studies/hilda_benchmarks --benchmark_filter='step/rA-half-1/'

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/linear_solver.hpp"
#include "studies/benchmarks/chain.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace hilda;

using Chain = const dae::Description& (*)(long bars);

void step(benchmark::State& timer, Chain chain, const lie::Scheme& scheme, lie::LinearSolver solver)
{
    const dae::Description& d = chain(timer.range(0));
    // Integrators in joint coordinates then compute no multipliers.
    const auto integrator = scheme.make(*d.model, {.linear_solver = solver, .multipliers = false});
    lie::State x = d.x;
    for (auto _ : timer) {
        integrator->step(x, 1e-3);
        if (x.t > 1) {  // restart after 1 s, so that the work does not depend on the number of steps
            timer.PauseTiming();
            x = d.x;
            timer.ResumeTiming();
        }
    }
    timer.counters["iterations_per_step"] = integrator->statistics().iterations_per_step();
    timer.SetComplexityN(timer.range(0));
}

const bool registered_step = [] {
    for (const lie::Scheme& scheme : lie::schemes()) {
        if (scheme.adaptive) continue;
        const bool saddle = scheme.formulation == "rA";
        for (const auto& [name, solver] : {std::pair{"klu", lie::LinearSolver::klu},
                                           std::pair{"condensed", lie::LinearSolver::condensed}}) {
            if (!saddle && solver == lie::LinearSolver::condensed) continue;
            for (const auto& [joint, chain] : {std::pair<const char*, Chain>{"step/", studies::chain},
                                               {"step-hinges/", studies::hinge_chain}}) {
                auto* b = benchmark::RegisterBenchmark((joint + scheme.name + "/" + name).c_str(), step,
                                                       chain, scheme, solver);
                for (const int bars : {2, 8, 64, 256, 1024, 4096}) b->Arg(bars);
                b->Unit(benchmark::kMicrosecond)->Complexity([](benchmark::IterationCount n) {
                    return static_cast<double>(n);
                });
            }
        }
    }
    return true;
}();

}  // namespace
