// SPDX-License-Identifier: GPL-3.0-or-later
/// Piles of balls and of boxes that fall into a bin, with rigid contacts and rA-moreau-1, e = 0, h = 1 ms.
/// A benchmark is a phase of the fall: `falling` until the first impact, `settling` until no body is faster
/// than 1 mm/s, at most 220 steps (60 for more than 2000 bodies), and `late`, the 100 steps after it (10 for
/// more than 200 bodies). Its time is the mean CPU time of a step. Counters: number of contact points with a
/// force, time per such point, iterations and factorisations of a step, largest overlap relative to the size,
/// largest residual until the end of the phase, number of steps with relaxed friction, and of steps in which
/// the energy has grown.
///
///     build/native/studies/hilda_benchmarks --benchmark_filter='^rigid_pile/balls/100/'

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/statistics.hpp"
#include "lie/system.hpp"
#include "lie/trajectory.hpp"
#include "run/simulation.hpp"
#include "studies/benchmarks/bin.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace {

using namespace hilda;

constexpr double h = 1e-3, at_rest = 1e-3;
constexpr const char* laws = R"("normal": {"type": "dvi"}, "friction": {"law": "coulomb", "mu_s": 0.3})";

/// Layers of side × side bodies of the width 0.1 m, each layer shifted against the one below, 5 mm above the
/// floor and each other, in a bin
std::string pile(bool boxes, long count)
{
    const auto side = std::max(2L, std::lround(std::cbrt(static_cast<double>(count) / 2)));
    const std::string surface = boxes ? R"({"type": "box", "lengths": [0.1, 0.1, 0.1]})"
                                      : R"({"type": "sphere", "radius": 0.05})",
                      shape = boxes ? R"({"box": [0.1, 0.1, 0.1]})" : R"({"sphere": 0.05})";
    std::string bodies,
        contacts = fmt::format(R"({{"name": "bodies", "bodies": "all", "surface": {}, {}}})", surface, laws);
    for (long b = 0; b < count; ++b) {
        const long layer = b / (side * side), x = b % side, y = b / side % side;
        const double shift = layer % 2 == 0 ? 0 : 0.01;
        bodies += fmt::format(R"({}{{"name": "b{}", "mass": 1, "shape": {}, "r": [{}, {}, {}]}})",
                              b > 0 ? "," : "", b, shape, (static_cast<double>(x) + 0.5) * 0.105 + shift,
                              (static_cast<double>(y) + 0.5) * 0.105 + shift / 2,
                              0.055 + static_cast<double>(layer) * 0.105);
    }
    const double width = static_cast<double>(side) * 0.105 + 0.01;
    contacts += studies::walls_of_bin(surface, laws, width);
    return fmt::format(R"({{"hilda_model": 1, "name": "pile", "bodies": [{}], "contacts": [{}]}})", bodies,
                       contacts);
}

enum Phase { falling, settling, late, phases };

struct Result {
    long steps = 0, grown = 0;
    double seconds = 0, contacts = 0;
    lie::Statistics of;  ///< counts of the phase; overlap and residual until its end
};

double largest_speed(const lie::State& x)
{
    double largest = 0;
    for (const lie::Motion& body : x.body) largest = std::max(largest, body.rdot.norm());
    return largest;
}

long loaded(const lie::State& x)
{
    return std::count_if(x.cone_forces.begin(), x.cone_forces.end(),
                         [](const lie::ConeForce& f) { return f.F.norm() > 0; });
}

std::array<Result, phases> fall(bool boxes, long count)
{
    dae::Description d = dae::read_model(pile(boxes, count), "pile");
    dae::start(d);
    const auto integrator = lie::scheme("rA-moreau-1").make(*d.model, {});
    lie::March run(d.x, *integrator, h);
    std::array<Result, phases> all;
    const long most[phases] = {100, count > 2000 ? 60 : 220, count > 200 ? 10 : 100};
    double energy = lie::energy(*d.model, d.x);
    for (int p = falling; p < phases; ++p) {
        Result& now = all[static_cast<size_t>(p)];
        const lie::Statistics before = integrator->statistics();
        bool ends = false;
        while (!ends && now.steps < most[p]) {
            const double start = run::thread_seconds();
            run.advance({});
            now.seconds += run::thread_seconds() - start;
            ++now.steps;
            const long points = loaded(run.node());
            now.contacts += static_cast<double>(points);
            const double after = lie::energy(*d.model, run.node());
            if (after > energy + 1e-9 * std::abs(energy)) ++now.grown;
            energy = after;
            ends = p == falling ? points > 0 : p == settling && largest_speed(run.node()) < at_rest;
        }
        now.of = integrator->statistics();
        now.of.add_counts(before, -1);
        now.contacts /= static_cast<double>(now.steps);
    }
    return all;
}

void phase(benchmark::State& timer, bool boxes, long count, Phase p)
{
    static std::map<std::pair<bool, long>, std::array<Result, phases>> results;
    const auto [at, is_new] = results.try_emplace({boxes, count});
    if (is_new) at->second = fall(boxes, count);
    const Result& of = at->second[p];
    const auto steps = static_cast<double>(of.steps);
    for (auto _ : timer) timer.SetIterationTime(of.seconds / steps);
    timer.counters["steps"] = steps;
    timer.counters["contacts"] = of.contacts;
    if (of.contacts > 0) timer.counters["us_contact"] = 1e6 * of.seconds / steps / of.contacts;
    timer.counters["iterations"] = static_cast<double>(of.of.cone_iterations) / steps;
    timer.counters["factorisations"] = static_cast<double>(of.of.cone_factorizations) / steps;
    timer.counters["overlap"] = of.of.overlap;
    timer.counters["residual"] = of.of.cone_residual;
    timer.counters["relaxed"] = static_cast<double>(of.of.friction_relaxed);
    timer.counters["energy_grows"] = static_cast<double>(of.grown);
}

const bool registered = [] {
    const auto add = [](bool boxes, long count) {
        const std::array<const char*, phases> names = {"falling", "settling", "late"};
        for (const Phase p : {falling, settling, late})
            benchmark::RegisterBenchmark(
                fmt::format("rigid_pile/{}/{}/{}", boxes ? "boxes" : "balls", count, names[p]).c_str(), phase,
                boxes, count, p)
                ->Iterations(1)
                ->UseManualTime()
                ->Unit(benchmark::kMicrosecond);
    };
    for (const long count : {10L, 100L, 1000L, 10000L}) add(false, count);
    for (const long count : {10L, 100L, 500L}) add(true, count);
    return true;
}();

}  // namespace
