// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/incline.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using studies::Incline;
using studies::InclineState;

namespace {

constexpr double degree = std::numbers::pi / 180;

contact::Scene after(const Incline& incline, double t)
{
    contact::Scene of = studies::scene(incline);
    while (of.t < t - 0.5e-4) of.step(1e-4);
    return of;
}

}  // namespace

TEST_CASE("friction and rolling torque hold a sphere at rest on a slope of 2 degrees", "[studies][incline]")
{
    const bool dissertation = GENERATE(true, false);
    const contact::Scene of = after({.alpha = 2 * degree, .dissertation = dissertation}, 0.8);
    CHECK(studies::state_of(of) == InclineState::rest);
    CHECK(of.pair[0].wrench.F.norm() == Approx(5 * 9.8 * std::sin(2 * degree)).margin(1e-8));
    CHECK(of.pair[0].wrench.T_i.norm() == Approx(0.2 * 5 * 9.8 * std::sin(2 * degree)).margin(1e-8));
}

TEST_CASE("the final state changes at the rest limit and at the rolling limit", "[studies][incline]")
{
    const double eta_r = GENERATE(0.3, 0.45, 0.55);
    const double rest = studies::rest_limit(eta_r) / degree, rolling = studies::rolling_limit(eta_r) / degree;
    const auto state = [&](double angle) {
        return studies::state_of(after({.alpha = angle * degree, .eta_r = eta_r}, 1));
    };
    CAPTURE(eta_r, rest, rolling);
    CHECK(state(rest - 0.3) == InclineState::rest);
    CHECK(state(rest + 0.1) == InclineState::rolling);
    CHECK(state(rolling - 0.9) == InclineState::rolling);
    CHECK(state(rolling + 0.2) == (eta_r < 0.5 ? InclineState::rolling_with_slip : InclineState::slip));
}

TEST_CASE("the accelerations of rolling with slip agree with the Coulomb bounds", "[studies][incline]")
{
    const Incline incline{.alpha = 28 * degree, .eta_r = 0.4};
    contact::Scene of = after(incline, 0.8);
    REQUIRE(studies::state_of(of) == InclineState::rolling_with_slip);
    const double N = 9.8 * std::cos(incline.alpha), R = Incline::R, mu_k = Incline::mu_k;  // [N/kg]
    CHECK(of.body[0].rddot.x() == Approx(-9.8 * std::sin(incline.alpha) + mu_k * N).margin(1e-9));
    CHECK((of.body[0].A * of.body[0].omegadot_bar).y() ==
          Approx(-(mu_k * N * R - 2 * incline.eta_r * R * mu_k * N) / (0.4 * R * R)).margin(1e-9));
}

#ifdef NDEBUG
TEST_CASE("the incline sweep compares the states with a published map", "[studies][incline]")
{
    const Scratch in;
    write(in / "other.csv", "# states\nnan,4,12,28\n0.2,0,1,1\n0.4,0,1,2\n0.6,0,0,1\n");
    const Ended ended =
        call(in, {"study", "incline-sweep", "--grid", "coarse", "--steps", "2e-4", "--against", "other.csv",
                  "--no-plot", "--expect", "far=0", "--expect", "slip_from=0.55", "--expect",
                  "agreement=88.9+-0.1", "--expect", "rest_limit=0+-0.6"});
    CAPTURE(ended.err);
    CHECK(ended.code == 6);  // at eta_r = 0.6 and 28 degrees the states differ
    CHECK_THAT(ended.err,
               Contains("expected far=0, got 1") && !Contains("slip_from") && !Contains("agreement"));
    CHECK_THAT(ended.out, Contains("published rolling, computed slip: 1"));
    const auto rows = csv(in / "out/incline-sweep/study.csv");
    REQUIRE(rows.size() == 9 * 30);
    CHECK(number(rows[3], "angle_deg") == 4);
    CHECK(rows[3].at("state") == "0");
    CHECK(rows[3].at("published") == "0");
    CHECK(rows[4].at("published").empty());
    CHECK(number(rows[11], "R_omega") == Approx(number(rows[11], "v")).margin(1e-9));  // rolling
}

TEST_CASE("the incline sweep checks its limits", "[studies][incline]")
{
    const Scratch in;
    write(in / "other.csv", "nan,4,12,28\n0.2,0,1,1\n0.4,0,1,2\n0.6,0,0,1\n");
    const std::string preset = GENERATE("dissertation", "balanced");
    const std::vector<std::string> words = {"study", "incline-sweep", "--grid",    "coarse",   "--steps",
                                            "2e-4",  "--check",       "--no-plot", "--preset", preset};
    const Ended good = call(in, words);
    CAPTURE(good.out, good.err);
    CHECK(good.code == 0);
    CHECK_THAT(good.out, Contains(preset == "balanced" ? "3 of 3 passed" : "5 of 5 passed"));

    std::vector<std::string> other = words;
    other.insert(other.end(), {"--against", "other.csv", "--force"});
    const Ended apart = call(in, other);
    CHECK(apart.code == 6);
    CHECK_THAT(apart.out, Contains(preset == "balanced" ? "3 of 4 passed" : "5 of 6 passed"));
}
#endif

TEST_CASE("a grid that ends at eta_r = 1/2 is not asked for slip without rolling (long)",
          "[studies][incline]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "incline-sweep", "--grid", "dissertation", "--steps", "1e-3",
                                  "--check", "--no-plot", "--jobs", "1"});
    CAPTURE(ended.out, ended.err);
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("of a grid up to eta_r = 1/2") && Contains("5 of 5 passed"));
}

TEST_CASE("the incline sweep rejects invalid options before the first run", "[studies][incline]")
{
    const Scratch in;
    write(in / "elsewhere.csv", "x,50,60\n0.2,0,0\n");
    const auto refused = [&](const std::vector<std::string>& more, int code, const std::string& message) {
        check_refused(in, with({"study", "incline-sweep"}, more), code, message);
    };
    refused({"--against", "elsewhere.csv"}, 3, "elsewhere.csv: has no cell of this grid");
    refused({"--grid", "fine"}, 2, "--grid: must be published, dissertation or coarse, got 'fine'");
    refused({"--steps", "1e-2"}, 3, "must not exceed its stability bound");
    refused({"--expect", "agrement=1"}, 2, "'agrement'; did you mean 'agreement'?");
}
