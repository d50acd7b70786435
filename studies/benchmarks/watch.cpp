// SPDX-License-Identifier: GPL-3.0-or-later
/// Cost of the checks of every node (Watch): runs of the N-bar pendulum and of a ball on a floor, without and
/// with it.
///
///     cmake --preset native && cmake --build --preset native --target hilda_benchmarks
///     build/native/studies/hilda_benchmarks --benchmark_filter='^march/'

#include "run/watch/watch.hpp"
#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "studies/benchmarks/chain.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace hilda;

const dae::Description& rolling_ball()
{
    static const dae::Description d = [] {
        dae::Description read = dae::read_model(studies::problem("rolling_ball").model, "rolling_ball");
        dae::start(read);
        return read;
    }();
    return d;
}

/// 1000 steps of 1e-3 s; steps for the ball: 1e-4 s
void march(benchmark::State& timer, const char* name, bool ball, bool watched)
{
    const dae::Description& d = ball ? rolling_ball() : studies::chain(timer.range(0));
    const lie::Scheme& scheme = lie::scheme(name);
    const double h = ball ? 1e-4 : 1e-3;
    lie::TimeGrid grid = lie::TimeGrid::over(1000 * h, h);
    grid.interval = grid.steps;
    for (auto _ : timer) {
        const auto integrator = scheme.make(*d.model, {});
        run::Watch watch(*d.model, d.x, *integrator, scheme, grid, run::Watch::Action::stop);
        lie::Observer* observers[] = {&watch};
        lie::March run(d.x, *integrator, h);
        const std::span<lie::Observer* const> all(observers, watched ? 1 : 0);
        while (run.number() < grid.steps) run.advance(all);
    }
}

const bool registered_watch = [] {
    for (const char* scheme : {"rA-half-1-momentum", "rA-half-1", "rA-rkmk-4"})
        for (const bool ball : {false, true})
            for (const bool watched : {false, true}) {
                const std::string name = std::string("march/") + scheme + (ball ? "/ball" : "/chain") +
                                         (watched ? "/watch" : "/none");
                auto* b = benchmark::RegisterBenchmark(name.c_str(), march, scheme, ball, watched);
                if (ball)
                    b->Arg(1);
                else
                    for (const int bars : {2, 16, 128}) b->Arg(bars);
                b->Unit(benchmark::kMillisecond);
            }
    return true;
}();

}  // namespace
