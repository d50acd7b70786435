// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "studies/framework/problem.hpp"
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// Σ ½ m v² + ½ ω̄ᵀ J̄ ω̄ - m g·r with the masses, inertias and gravity of Table 3.2
double double_pendulum_energy(const lie::State& x)
{
    const double m[] = {312, 156};
    const Eigen::Vector3d J[] = {{0.52, 416.26, 416.26}, {0.26, 52.13, 52.13}};
    double e = 0;
    for (int b = 0; b < 2; ++b)
        e += 0.5 * m[b] * x.body[b].rdot.squaredNorm() + 0.5 * x.body[b].omega_bar.cwiseAbs2().dot(J[b]) +
             m[b] * 9.81 * x.body[b].r.z();
    return e;
}

}  // namespace

TEST_CASE("the energy study agrees with the energy computed from the states", "[studies][energy]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "energy", "--problem", "double_pendulum", "--integrator",
                                  "rA-half-1", "--end", "0.2", "--steps", "1e-3", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("E-E0 at end [J]"));

    dae::Description d = dae::read_model(studies::problem("double_pendulum").model, "double_pendulum");
    dae::start(d);
    const auto integrator = lie::scheme("rA-half-1").make(*d.model, {});
    const lie::Trajectory run = lie::march(d.x, *integrator, lie::TimeGrid::over(0.2, 1e-3));
    double largest = 0;
    const double start = double_pendulum_energy(run.row.front());
    for (const lie::State& x : run.row)
        largest = std::max(largest, std::abs(double_pendulum_energy(x) - start));

    const auto rows = csv(in / "out/energy/study.csv");
    REQUIRE(rows.size() == 1);
    const double rounding = 1e-10 * std::abs(start);
    CHECK(number(rows[0], "end_drift") ==
          Approx(double_pendulum_energy(run.row.back()) - start).margin(rounding));
    CHECK(number(rows[0], "max_drift") == Approx(largest).margin(rounding));
    CHECK(number(rows[0], "max_drift_relative") ==
          Approx(number(rows[0], "max_drift") / number(rows[0], "max_kinetic")));
    CHECK(rows[0].at("status") == "ok");

    const auto curve = csv(in / "out/energy/energy.csv");
    REQUIRE(curve.size() == 201);
    for (size_t k = 0; k < curve.size(); ++k) {
        CHECK(number(curve[k], "t") == Approx(run.row[k].t).margin(1e-15));
        CHECK(number(curve[k], "energy") == Approx(double_pendulum_energy(run.row[k])).margin(rounding));
        CHECK(number(curve[k], "drift") ==
              Approx(double_pendulum_energy(run.row[k]) - start).margin(rounding));
    }
}

#ifdef NDEBUG
TEST_CASE("rA-half-1 gains 236 J and rA-full-1 loses 1875 J on the spinning two-bar pendulum",
          "[studies][energy]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "energy", "--problem", "n_pendulum_2_spin", "--integrator",
                                  "rA-half-1,rA-full-1", "--no-plot", "--quiet"});
    REQUIRE(ended.code == 0);
    const auto rows = csv(in / "out/energy/study.csv");
    REQUIRE(rows.size() == 2);
    CHECK(number(rows[0], "end_drift") == Approx(236).margin(1));
    CHECK(number(rows[1], "end_drift") == Approx(-1875).margin(5));
    CHECK(csv(in / "out/energy/energy.csv").size() <= 2 * 1001);
}
#endif

TEST_CASE("an expectation of the energy study applies to every run", "[studies][energy]")
{
    const Scratch in;
    const std::vector<std::string> study = {"study", "energy",  "--problem", "double_pendulum", "--end",
                                            "0.01",  "--quiet", "--no-plot", "--integrator",    "rA-half-2"};
    const auto with = [&](const std::string& expectation) {
        auto arguments = study;
        arguments.insert(arguments.end(), {"--force", "--expect", expectation});
        return call(in, arguments);
    };
    CHECK(with("max_drift=0+-1").code == 0);
    CHECK(with("max_drift=1000").code == 6);
    const Ended unknown = with("max_drif=0");
    CHECK(unknown.code == 2);
    CHECK_THAT(unknown.err, Contains("'max_drif'; did you mean 'max_drift'?"));
}

TEST_CASE("the energy study balances the work of a driven model and says which models are conservative",
          "[studies][energy]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "energy", "--problem", "double_pendulum,single_pendulum",
                                  "--integrator", "rA-rattle", "--end", "0.5", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(
        ended.out,
        Contains("double_pendulum, end time 0.5 s: change of the energy E = T + V (conservative model)"));
    CHECK_THAT(ended.out, Contains("single_pendulum, end time 0.5 s: balance of the energy"));
    CHECK_THAT(ended.out, Contains("not conservative: driver 'DP1-drive'"));
    const auto rows = csv(in / "out/energy/study.csv");
    REQUIRE(rows.size() == 2);
    CHECK(number(rows[0], "end_balance") == number(rows[0], "end_drift"));
    CHECK(number(rows[0], "work_drivers") == 0);
    CHECK(std::abs(number(rows[1], "end_drift")) > 1);
    CHECK(number(rows[1], "work_drivers") == Approx(number(rows[1], "end_drift")).epsilon(1e-7));
    CHECK(std::abs(number(rows[1], "max_balance")) < 1e-6 * std::abs(number(rows[1], "end_drift")));
    const nlohmann::json study = nlohmann::json::parse(read(in / "out/energy/study.json"));
    CHECK(study.at("models")[0].at("conservative") == true);
    CHECK(study.at("models")[1].at("conservative") == false);
    CHECK(study.at("models")[1].at("work_of")[0] == "driver 'DP1-drive'");
}

TEST_CASE("with --strict a study with a warning about a run ends with exit code 4 after its results",
          "[studies][energy]")
{
    const Scratch in;
    // 0.49 rad in one step
    const std::vector<std::string> study = {"study",        "energy",    "--problem", "double_pendulum",
                                            "--integrator", "rA-half-1", "--steps",   "0.1",
                                            "--end",        "1",         "--no-plot"};
    const Ended warned = call(in, with(study, {"--output", "a"})),
                strict = call(in, with(study, {"--output", "b", "--strict"}));
    CAPTURE(warned.out, strict.err);
    CHECK(warned.code == 0);
    CHECK_THAT(warned.out, Contains("warnings, in study.json for each run: large_turn (1 run)"));
    CHECK(strict.code == 4);
    CHECK_THAT(
        strict.err,
        Contains("hilda: error[large_turn]: study energy: rA-half-1 on double_pendulum at h = 0.1 s: ") &&
            Contains(" (a warning, with --strict)"));
    CHECK(read(in / "b/study.csv").substr(0, 40) == read(in / "a/study.csv").substr(0, 40));
    CHECK(call(in, {"study", "energy", "--problem", "double_pendulum", "--integrator", "rA-half-1", "--steps",
                    "1e-3", "--end", "0.1", "--no-plot", "--strict", "--output", "c"})
              .code == 0);
    CHECK(call(in, {"study", "friction", "--strict"}).code == 2);
}

TEST_CASE("the option --check compares the studies of Chapter 3 with the statements of the dissertation",
          "[studies][energy]")
{
    const Scratch in;
    const std::vector<std::string> energy = {"study", "energy", "--check", "--problem", "double_pendulum"};
    const auto checks = [&](const std::vector<std::string>& study, int code, const std::string& result) {
        const Ended ended = call(in, with(study, {"--no-plot", "--force", "--output", "a"}));
        CAPTURE(ended.out, ended.err);
        CHECK(ended.code == code);
        CHECK_THAT(ended.out, Contains('\n' + result + '\n'));
        CHECK(nlohmann::json::parse(read(in / "a/study.json")).contains("checks"));
    };
    checks(with(energy, {"--integrator", "rA-full-1,rA-half-1"}), 0, "2 of 2 passed");
    // after 1 s the fully implicit scheme has lost 1 % of the energy
    checks(with(energy, {"--integrator", "rA-full-1,rA-half-1", "--end", "1"}), 6, "1 of 2 passed");
    checks({"study", "snapshots", "--check"}, 0, "6 of 6 passed");
    checks({"study", "iterations", "--check", "--integrator", "rA-full-1,rA-half-1,rA-half-2", "--steps",
            "1e-2"},
           0, "6 of 6 passed");
    checks({"study", "convergence", "--check", "--problem", "double_pendulum,four_link", "--integrator",
            "rA-half-1,rA-half-2", "--steps", "4e-3,2e-3,1e-3"},
           0, "4 of 4 passed");
    checks({"study", "timing", "--check", "--integrator", "rA-half-1", "--steps", "1e-2", "--repeats", "1"},
           6,
           "0 of 3 passed");  // without rA-full-1 there is no ratio
    checks({"study", "contact-methods", "--check", "--problem", "bowl"}, 0, "1 of 1 passed");
}
