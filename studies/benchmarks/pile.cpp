// SPDX-License-Identifier: GPL-3.0-or-later
/// Piles of balls in a box, each two a compliant contact with friction: reading and start, and a step of
/// rA-half-1. The counter pairs_near is the number of the pairs that are close to each other, of N (N - 1)/2
/// pairs of balls and 5 N of balls and walls.
///
///     cmake --preset native && cmake --build --preset native --target hilda_benchmarks
///     build/native/studies/hilda_benchmarks --benchmark_filter='^pile/'

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "studies/benchmarks/bin.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <map>

namespace {

using namespace hilda;

/// Layers of balls of radius 0.05 m that nearly touch each other, each layer shifted against the one below
std::string pile(long balls)
{
    const auto side = std::max(2L, std::lround(std::cbrt(static_cast<double>(balls) / 2)));
    const std::string laws =
        R"("normal": {"type": "hertz", "E_star": 1e6, "restitution": 0.5}, "friction": {"mu_s": 0.3, "K_E": 1e4})";
    const std::string surface = R"({"type": "sphere", "radius": 0.05})";
    std::string bodies,
        contacts = fmt::format(R"({{"name": "balls", "bodies": "all", "surface": {}, {}}})", surface, laws);
    for (long b = 0; b < balls; ++b) {
        const long layer = b / (side * side), x = b % side, y = b / side % side;
        const double shift = layer % 2 == 0 ? 0 : 0.005;
        bodies += fmt::format(
            R"({}{{"name": "b{}", "mass": 1, "inertia": [1e-3, 1e-3, 1e-3], "r": [{}, {}, {}]}})",
            b > 0 ? "," : "", b, (static_cast<double>(x) + 0.5) * 0.102 + shift,
            (static_cast<double>(y) + 0.5) * 0.102 + shift / 2, 0.05 + static_cast<double>(layer) * 0.10005);
    }
    const double width = static_cast<double>(side) * 0.102 + 0.01;
    contacts += studies::walls_of_bin(surface, laws, width);
    return fmt::format(R"({{"hilda_model": 1, "name": "pile", "bodies": [{}], "contacts": [{}]}})", bodies,
                       contacts);
}

dae::Description started(long balls)
{
    dae::Description d = dae::read_model(pile(balls), "pile");
    dae::start(d);
    return d;
}

void count_pairs(const dae::Model& model, const lie::State& x, benchmark::State& timer)
{
    long near = 0;
    model.near_forces().visit(x, [&](const dae::Force&, int) { ++near; });
    timer.counters["pairs_near"] = static_cast<double>(near);
}

void start(benchmark::State& timer)
{
    for (auto _ : timer) benchmark::DoNotOptimize(started(timer.range(0)).x.t);
}

void step(benchmark::State& timer)
{
    static std::map<long, dae::Description> made;
    const auto [at, is_new] = made.try_emplace(timer.range(0));
    if (is_new) at->second = started(timer.range(0));
    const dae::Description& d = at->second;
    const auto integrator = lie::scheme("rA-half-1").make(*d.model, {});
    lie::March run(d.x, *integrator, 1e-5);
    for (auto _ : timer) run.advance({});
    count_pairs(*d.model, run.node(), timer);
}

BENCHMARK(start)->Name("pile/start")->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);
BENCHMARK(step)->Name("pile/step")->Arg(50)->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);

}  // namespace
