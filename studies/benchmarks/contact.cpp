// SPDX-License-Identifier: GPL-3.0-or-later
/// Time of a step with compliant contacts, h = 1e-4 s: the sphere on an incline and the stack of three
/// spheres, with both presets of the friction law.
///
///     build/native/studies/hilda_benchmarks --benchmark_filter=contact/

#include "studies/experiments/chapter4/incline.hpp"
#include "studies/experiments/chapter4/stack.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace hilda;

template <class Start>
void step(benchmark::State& timer, const Start& start)
{
    contact::Scene of = studies::scene(start);
    for (auto _ : timer) {
        of.step(1e-4);
        if (of.t > 0.8) {  // restart, so that the motion does not depend on the number of steps
            timer.PauseTiming();
            of = studies::scene(start);
            timer.ResumeTiming();
        }
    }
}

const bool registered_contact = [] {
    for (const bool dissertation : {true, false}) {
        const std::string preset = dissertation ? "dissertation" : "balanced";
        const studies::Incline incline{.alpha = 0.2, .eta_r = 0.3, .dissertation = dissertation};
        const studies::Stack stack{.gap = 0.3, .top = 1.7, .eta_r = 0.22, .dissertation = dissertation};
        benchmark::RegisterBenchmark(("contact/incline/" + preset).c_str(), step<studies::Incline>, incline);
        benchmark::RegisterBenchmark(("contact/stack/" + preset).c_str(), step<studies::Stack>, stack);
    }
    return true;
}();

}  // namespace
