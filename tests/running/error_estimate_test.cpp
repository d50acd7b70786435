// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/error_estimate.hpp"

#include "contact/evolving/unilateral.hpp"
#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "studies/framework/problem.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

using namespace hilda;
using Catch::Matchers::Contains;

namespace {

struct Case {
    const char *problem, *scheme;
    double h;
};

/// Largest differences of r, A, v, omega, F and T over rows and bodies
std::array<double, 6> largest_errors(const dae::Model& model, const lie::Trajectory& run,
                                     const lie::Trajectory& exact)
{
    std::array<double, 6> e{};
    for (size_t n = 0; n < run.row.size(); ++n) {
        const lie::State &x = run.row[n], &y = exact.row[n];
        const auto loads = dae::reactions(model, x), of_y = dae::reactions(model, y);
        for (size_t k = 0; k < loads.size(); ++k) {
            const lie::Motion &a = x.body[static_cast<int>(k)], &b = y.body[static_cast<int>(k)];
            const double trace = (a.A.transpose() * b.A).trace();
            const double angle =
                trace > 2.99 ? (a.A - b.A).norm() / std::sqrt(2.) : std::acos((trace - 1) / 2);
            const double of[] = {(a.r - b.r).norm(),
                                 angle,
                                 (a.rdot - b.rdot).norm(),
                                 (a.omega_bar - b.omega_bar).norm(),
                                 (loads[k].F - of_y[k].F).norm(),
                                 (loads[k].T - of_y[k].T).norm()};
            for (size_t q = 0; q < 6; ++q) e[q] = std::max(e[q], of[q]);
        }
    }
    return e;
}

}  // namespace

// References: the equations of motion in two angles, and the index-1 equations, both at 1e-13.
TEST_CASE("the estimated error of a run is within a factor of two of its error", "[run][run][error]")
{
    const Case c = GENERATE(
        Case{"double_pendulum_moving", "rA-half-1", 1e-3}, Case{"double_pendulum_moving", "rA-full-1", 1e-3},
        Case{"double_pendulum_moving", "rA-half-2", 1e-3},
        Case{"double_pendulum_moving", "rA-half-1-momentum", 1e-3},
        Case{"double_pendulum_moving", "rA-rkmk-4", 1e-2}, Case{"slider_crank", "rA-half-1", 1e-3},
        Case{"slider_crank", "rA-full-1", 1e-4}, Case{"slider_crank", "rA-half-2", 1e-3},
        Case{"slider_crank", "rA-genalpha", 1e-3}, Case{"slider_crank", "rA-rkmk-4", 1e-2});
    CAPTURE(c.problem, c.scheme);
    studies::Problem problem = studies::problem(c.problem);
    if (problem.name == "slider_crank") {  // without its driver: with one degree of freedom
        auto model = nlohmann::ordered_json::parse(problem.model);
        auto& constraints = model["constraints"];
        const size_t before = constraints.size();
        constraints.erase(std::remove_if(constraints.begin(), constraints.end(),
                                         [](const auto& k) { return k["name"] == "driver"; }),
                          constraints.end());
        REQUIRE(constraints.size() == before - 1);
        problem.model = model.dump();
        problem.reference_solution = [](dae::Description& free, const std::vector<double>& t) {
            return reference::reference_solution(*free.model, free.x, t);
        };
    }
    dae::Description d = dae::read_model(problem.model, problem.name);
    dae::start(d);
    const lie::Scheme& scheme = lie::scheme(c.scheme);
    lie::Settings settings;
    settings.tolerance = 1e-12;
    const auto integrator = contact::make_integrator(*d.model, scheme, settings);
    const lie::TimeGrid grid = lie::TimeGrid::over(1, c.h, 0.05);
    run::RefinedRuns refined(*d.model, d.x, scheme, settings, grid);
    lie::Observer* observers[] = {&refined};
    const lie::Trajectory run = lie::march(d.x, *integrator, grid, observers);
    const run::ErrorEstimate estimate = refined.estimate(0);
    CHECK(estimate.until == Approx(1));
    CHECK_THAT(refined.estimate(2).doubts.at(0), Contains("2 contact events"));

    std::vector<double> times;
    for (const lie::State& x : run.row) times.push_back(x.t);
    const lie::Trajectory exact = problem.reference_solution(d, times);
    const std::array<double, 6> errors = largest_errors(*d.model, run, exact);
    int compared = 0;
    for (size_t q = 0; q < 6; ++q) {
        const run::ErrorEstimate::Quantity& of = estimate.quantities[q];
        CAPTURE(of.name, of.error, errors[q], of.observed_order);
        CHECK(of.order == (q < 4 ? scheme.order : scheme.order_lambda));
        if (errors[q] < (q < 4 ? 1e-8 : 1e-5)) continue;  // rounding
        ++compared;
        CHECK(of.error > errors[q] / 2);
        CHECK(of.error < errors[q] * 2);
    }
    CHECK(compared >= 3);
    for (const std::string& doubt : estimate.doubts)
        CHECK_THAT(doubt, Contains("the error is probably smaller"));
}

TEST_CASE("an unreliable estimate of the error says so", "[run][run][error]")
{
    const tests::Scratch in;
    const auto doubts = [&](const std::vector<std::string>& arguments) {
        const tests::Ended ended =
            tests::call(in, tests::with({"run", "--error", "--json", "--output", "a", "--force"}, arguments));
        CAPTURE(arguments, ended.err);
        REQUIRE(ended.code == 0);
        const auto estimate = nlohmann::json::parse(ended.out)["error_estimate"];
        CHECK(estimate["reliable"] == estimate["doubts"].empty());
        return estimate["doubts"].dump();
    };
    CHECK(doubts({"double_pendulum_moving", "--end", "1"}) == "[]");
    CHECK_THAT(doubts({"double_pendulum", "--end", "5", "--step", "0.05"}),
               Contains("the observed order is"));

    const studies::Problem problem = studies::problem("double_pendulum");
    dae::Description d = dae::read_model(problem.model, problem.name);
    dae::start(d);
    const lie::TimeGrid many_steps = lie::TimeGrid::over(1000, 1e-3);
    const run::RefinedRuns refined(*d.model, d.x, lie::scheme("rA-half-1"), {}, many_steps);
    CHECK_THAT(refined.estimate(0).doubts.at(0), Contains("the order is not measured"));
}

TEST_CASE("the option --error does not change the files of a run, and needs a whole run with a fixed step",
          "[run][run][error]")
{
    const tests::Scratch in;
    const std::vector<std::string> run = {"run", "slider_crank", "--reactions", "--end", "0.5", "--output"};
    REQUIRE(tests::call(in, tests::with(run, {"a"})).code == 0);
    const tests::Ended ended = tests::call(in, tests::with(run, {"b", "--error"}));
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("errors        r ") && Contains(" m, A ") && Contains(" rad/s, F "));
    CHECK(tests::read(in / "a/trajectory.csv") == tests::read(in / "b/trajectory.csv"));
    const auto a = nlohmann::json::parse(tests::read(in / "a/summary.json")),
               b = nlohmann::json::parse(tests::read(in / "b/summary.json"));
    CHECK(a["counters"] == b["counters"]);
    CHECK(a["invariants"] == b["invariants"]);
    CHECK_FALSE(a.contains("error_estimate"));
    CHECK(b["error_estimate"]["r"]["order"] == 2);
    CHECK(b["error_estimate"]["omega"]["observed_order"].get<double>() == Approx(2).margin(0.1));

    tests::check_refused(in, tests::with(run, {"b", "--error", "--resume"}), 2, "--error");
    tests::check_refused(in, tests::with(run, {"c", "--error", "--integrator", "ida-rp"}), 2,
                         "--error is for fixed-step schemes");
    CHECK(tests::call(in, {"run", "slider_crank", "--error", "--end", "0", "--output", "d"}).code == 0);
}
