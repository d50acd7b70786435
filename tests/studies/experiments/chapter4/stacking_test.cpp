// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/stack_snapshots.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using studies::Stack;
using studies::StackOutcome;
namespace stacked = studies::stacked;

TEST_CASE("friction and rolling torques on a lower sphere at rest are balanced about its centre",
          "[studies][stacking]")
{
    const bool dissertation = GENERATE(true, false);
    contact::Scene of = studies::scene({.gap = 0.3, .top = 1.2, .eta_r = 0.25, .dissertation = dissertation});
    REQUIRE(studies::run_until_decided(of, 1e-4, 10).state == StackOutcome::stable);
    for (int n = 0; n < 8000; ++n) of.step(1e-4);
    REQUIRE(of.kinetic_energy() < 1e-14);
    const contact::Scene::Pair &above = of.pair[stacked::top_right], &below = of.pair[stacked::right_ground];
    const lie::Vec3 r = of.body[stacked::right].r;
    const double lever_s = (above.contact_state.contact_point.C() - r).norm(),
                 lever_g = (below.contact_state.contact_point.C() - r).norm();
    const double F_s = above.wrench.F.norm(), F_g = below.wrench.F.norm();
    const double T_s = above.wrench.T_j.norm(), T_g = below.wrench.T_i.norm();
    CAPTURE(dissertation, lever_s, lever_g, F_s, F_g, T_s, T_g);
    CHECK(lever_g * F_g - lever_s * F_s == Approx(T_g + T_s).margin(1e-6));
    CHECK(std::abs(Stack::R * (F_g - F_s) - (T_g + T_s)) > 1e-5);  // the overlaps shorten the lever arms
    CHECK(2 * below.contact_state.N == Approx((2 + 1.2) * 9.81).margin(1e-5));
}

TEST_CASE("the ground forces of the stack with 1.7 kg and eta_r = 0.22 agree with the published run",
          "[studies][stacking]")
{
    contact::Scene of = studies::scene({.gap = 0.3, .top = 1.7, .eta_r = 0.22});
    const auto at = [&](double t) {
        while (of.t < t + 0.5e-4) of.step(1e-4);  // the loads are those of the previous node
        const contact::Scene::Pair& below = of.pair[stacked::right_ground];
        return std::pair(below.wrench.F.norm(), below.contact_state.N);
    };
    CHECK(at(0.005).first == Approx(0.386).margin(0.005));
    CHECK(at(0.010).first == Approx(1.525).margin(0.005));
    CHECK(at(0.020).first == Approx(4.706).margin(0.005));
    CHECK(at(0.050).first == Approx(3.523).margin(0.005));
    CHECK(at(0.100).second == Approx(22.453).margin(0.02));
}

TEST_CASE("the stacks of the snapshots stand, or collapse by the friction that the dissertation names",
          "[studies][stacking]")
{
    // gap 0.3 R; the heaviest upper spheres that stand, and 0.01 kg more
    const auto [eta_r, top, rolls, slides] = GENERATE(table<double, double, bool, bool>(
        {{0.16, 0.957, true, false}, {0.23, 1.758, true, true}, {0.35, 1.575, false, true}}));
    CAPTURE(eta_r);
    const auto stands = studies::stack_snapshots({.gap = 0.3, .top = top, .eta_r = eta_r}, "x", 1e-4, 1);
    CHECK_FALSE(stands.collapses);
    CHECK(stands.t == Approx(1).margin(2e-4));
    const auto falls =
        studies::stack_snapshots({.gap = 0.3, .top = top + 0.01, .eta_r = eta_r}, "x", 1e-4, 10);
    CHECK(falls.collapses);
    CHECK(falls.roll_saturates == rolls);
    CHECK(falls.slide_saturates == slides);
    // the lower spheres turn only if they roll
    const auto rows = [&](const std::string& body) {
        std::vector<std::vector<std::string>> all;
        std::istringstream in(falls.tables.poses);
        for (std::string line; std::getline(in, line);)
            if (line.starts_with("x," + body + ',')) all.push_back(fields(line));
        return all;
    };
    const auto right = rows("right"), upper = rows("top");
    const double turned = std::abs(std::stod(right.back()[9]));  // A13
    CHECK((turned > 0.2) == !slides);
    CHECK(std::stod(upper.front()[6]) - std::stod(upper.back()[6]) == Approx(0.5 * Stack::R).epsilon(0.01));
}

#ifdef NDEBUG
TEST_CASE("a stable stack remains at rest and a collapsing stack falls to the ground", "[studies][stacking]")
{
    const auto [gap, eta_r, m_c, rolls] = GENERATE(table<double, double, double, bool>(
        {{0.20, 0.15, 1.115, true}, {0.30, 0.22, 1.740, true}, {0.40, 0.30, 1.379, false}}));
    CAPTURE(gap, eta_r);
    contact::Scene light = studies::scene({.gap = gap, .top = m_c - 1e-3, .eta_r = eta_r});
    REQUIRE(studies::run_until_decided(light, 1e-4, 10).state == StackOutcome::stable);
    const double z = light.body[stacked::top].r.z();
    for (int n = 0; n < 10000; ++n) light.step(1e-4);
    CHECK(light.body[stacked::top].r.z() == Approx(z).margin(1e-6));

    contact::Scene heavy = studies::scene({.gap = gap, .top = m_c, .eta_r = eta_r});
    const StackOutcome outcome = studies::run_until_decided(heavy, 1e-4, 10);
    REQUIRE(outcome.state == StackOutcome::collapses);
    CHECK(outcome.rolls == rolls);
    CHECK(outcome.slides != rolls);
    for (int n = 0; n < 20000 && heavy.body[stacked::top].r.z() > 1.05 * Stack::R; ++n) heavy.step(1e-4);
    CHECK(heavy.body[stacked::top].r.z() < 1.05 * Stack::R);  // on the ground
}

TEST_CASE("the stacking study finds critical masses and compares them with a file", "[studies][stacking]")
{
    const Scratch in;
    write(in / "other.csv", "eta_r,m_c_gap_0.20R,m_c_gap_0.40R\n0.15,1.105,\n0.60,1.85,1.37\n");
    const Ended ended =
        call(in, {"study", "stacking", "--grid", "coarse", "--quiet", "--no-plot", "--against", "other.csv",
                  "--expect", "peak_eta_0.20R=0.21", "--expect", "plateau_0.40R=1.374+-0.002", "--expect",
                  "largest=0.01+-0.002", "--expect", "undecided=0", "--expect", "rms=0+-1e-4"});
    CAPTURE(ended.err);
    CHECK(ended.code == 6);
    CHECK_THAT(ended.err, Contains("expected rms=0+-1e-4, got 0.0"));
    CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
    const auto rows = csv(in / "out/stacking/study.csv");
    REQUIRE(rows.size() == 8);
    CHECK(number(rows[0], "critical_mass") == Approx(1.115).margin(1.5e-3));
    CHECK(number(rows[0], "difference") == Approx(number(rows[0], "critical_mass") - 1.105));
    CHECK(rows[0].at("collapse_mode") == "rolling");
    CHECK(rows[1].at("published").empty());
    CHECK(rows[3].at("collapse_mode") == "sliding");
    CHECK(number(rows[6], "critical_mass") == Approx(1.553).margin(1.5e-3));
}

TEST_CASE("the stacking study evaluates its acceptance criteria", "[studies][stacking]")
{
    const Scratch in;
    const std::vector<std::string> words = {"study",   "stacking",  "--grid", "coarse",
                                            "--quiet", "--no-plot", "--check"};
    const Ended good = call(in, words);
    CAPTURE(good.err);
    CHECK(good.code == 0);
    const std::string json = read(in / "out/stacking/study.json");
    CHECK_THAT(
        json,
        Contains("critical mass with h = 2e-05 s minus that with h = 0.0001 s, gap 0.40R, eta_r = 0.24"));

    write(in / "other.csv", "eta_r,m_c_gap_0.20R,m_c_gap_0.40R\n0.15,1.105,\n0.60,1.815,1.37\n");
    std::vector<std::string> other = {"study",   "stacking", "--grid",    "coarse",   "--no-plot",
                                      "--check", "--force",  "--against", "other.csv"};
    const Ended apart = call(in, other);
    CHECK(apart.code == 6);
    CHECK_THAT(apart.out, Contains("5 of 7 passed") && Contains("largest difference to the file [kg]"));
}
#endif

TEST_CASE("the stacking study rejects invalid options before the first run", "[studies][stacking]")
{
    const Scratch in;
    const auto refused = [&](const std::vector<std::string>& more, int code, const std::string& message) {
        check_refused(in, with({"study", "stacking"}, more), code, message);
    };
    write(in / "bad.csv", "eta_r,m_c_gap_0.20R\n0.15,x\n");
    write(in / "less.csv", "eta_r,m_c_gap_0.20R\n0.15,1\n");
    refused({"--against", "bad.csv"}, 3, "bad.csv:2: m_c_gap_0.20R must be a number, got 'x'");
    refused({"--against", "less.csv"}, 3, "less.csv: there is no column 'm_c_gap_0.25R'");
    refused({"--against", "none.csv"}, 3, "none.csv");
    refused({"--grid", "fine"}, 2, "--grid: must be dissertation or coarse, got 'fine'");
    refused({"--preset", "thesis"}, 2, "--preset: must be balanced or dissertation, got 'thesis'");
    refused({"--problem", "four_link"}, 2, "--problem is for studies of models");
    refused({"--steps", "1e-2"}, 3, "must not exceed its stability bound");
}
