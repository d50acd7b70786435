// SPDX-License-Identifier: GPL-3.0-or-later
/// Time of a step with contact constraints over the number of contacts: each a ball of radius 0.5 m that
/// slides in a bowl with semi-axes 4, 3, 2 m, at h = 5e-3 s and with a tolerance that needs about four
/// iterations. Linear solvers: KLU with 13 unknowns per contact, and condensed to one unknown per contact.
///
///     cmake --preset native && cmake --build --preset native --target hilda_benchmarks
///     build/native/studies/hilda_benchmarks --benchmark_filter=evolving/

#include "contact/evolving/contact.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/linear_solver.hpp"

#include <benchmark/benchmark.h>

#include <map>

namespace {

using namespace hilda;
using lie::Vec3;

constexpr double h = 5e-3;

struct Bowls {
    dae::Model model;
    lie::State x;

    explicit Bowls(long balls)
    {
        const contact::Shape ball{std::make_shared<contact::Sphere>(0.5)};
        const auto bowl = std::make_shared<contact::Ellipsoid>(Vec3(4, 3, 2), true);
        for (long k = 0; k < balls; ++k) {
            const long column = k % 50, row = k / 50;
            const Vec3 place(10.0 * static_cast<double>(column), 10.0 * static_cast<double>(row), 0);
            model.add({"ball " + std::to_string(k), 1, 0.1 * lie::Mat3::Identity()});
            model.constrain("bowl " + std::to_string(k),
                            std::make_unique<contact::EvolvingContact>(static_cast<int>(k), ball, dae::ground,
                                                                       contact::Shape{bowl, place}));
            lie::Motion motion;
            motion.r = place + Vec3(0.93073643551905849, 1.3152971613841562, -1.1988698851259592);
            x.body.push_back(motion);
        }
        dae::start(model, x);
    }
};

const Bowls& bowls(long balls)
{
    static std::map<long, std::unique_ptr<Bowls>> all;
    std::unique_ptr<Bowls>& made = all[balls];
    if (!made) made = std::make_unique<Bowls>(balls);
    return *made;
}

void evolving(benchmark::State& timer, const std::string& scheme, lie::LinearSolver solver)
{
    const Bowls& start = bowls(timer.range(0));
    const auto integrator = lie::scheme(scheme).make(
        start.model, {.tolerance = 1e-10, .max_iterations = 10, .linear_solver = solver});
    lie::State x = start.x, before;
    for (auto _ : timer) {
        before = x;
        integrator->step(x, h);
        start.model.accepted(before, x);
        if (x.t > 2) {  // restart, so that the work does not depend on the number of steps
            timer.PauseTiming();
            x = start.x;
            timer.ResumeTiming();
        }
    }
    timer.counters["iterations_per_step"] = integrator->statistics().iterations_per_step();
    timer.counters["per_contact"] =
        benchmark::Counter(static_cast<double>(timer.range(0)),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    timer.SetComplexityN(timer.range(0));
}

const bool registered_evolving = [] {
    for (const char* name : {"rA-half-1", "rA-half-1-momentum"})
        for (const auto& [by, solver] : {std::pair{"klu", lie::LinearSolver::klu},
                                         std::pair{"condensed", lie::LinearSolver::condensed}}) {
            auto* b = benchmark::RegisterBenchmark((std::string("evolving/") + name + "/" + by).c_str(),
                                                   evolving, std::string(name), solver);
            for (const int balls : {1, 10, 100, 1000, 2000}) b->Arg(balls);
            b->Unit(benchmark::kMicrosecond)->Complexity([](benchmark::IterationCount n) {
                return static_cast<double>(n);
            });
        }
    return true;
}();

}  // namespace
