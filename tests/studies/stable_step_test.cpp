// SPDX-License-Identifier: GPL-3.0-or-later
/// Stability limits of forces: steps above them are rejected by hilda run and by studies.

#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "run/single_run.hpp"
#include "tests/support/bristle_contacts.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using run::SingleRun;

namespace {

/// A body of 1 kg on a bristle of 18.5 kN/m, with the stability limit 2/sqrt(18500) s = 14.704 ms
struct BristleModel {
    const tests::BristleContacts reader;
    const tests::Scratch in;
    run::RunOptions options;

    BristleModel()
    {
        tests::write(in / "m.json",
                     R"({"hilda_model": 1, "name": "m", "end": 0.3,
 "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 1]}],
 "contacts": [{"name": "brush", "body_i": "ground", "body_j": "bar", "stiffness": 18500}]})");
        options.model = (in / "m.json").string();
        options.quiet = true;
    }
    run::RunResult run(const std::string& scheme = "rA-half-1") const
    {
        return SingleRun(options, lie::scheme(scheme), directory()).execute();
    }
    std::string directory() const { return (in / "out").string(); }
};

}  // namespace

TEST_CASE("a step above the stability limit of a force is rejected with its name before any file is written",
          "[studies][stable_step]")
{
    BristleModel m;
    m.options.step = 0.015;
    CHECK_THROWS_AS(m.run(), io::UsageError);
    CHECK_THROWS_WITH(m.run(),
                      "run: the step 0.015 s is above 0.0147 s, the stability limit of bristle 'brush' in an "
                      "explicit step; --accept-step accepts it");
    CHECK_FALSE(tests::fs::exists(m.directory()));

    m.options.accept_step = true;
    CHECK(m.run().step == 0.015);
    m.options.force = true;  // the next runs overwrite it, which accepts no step
    m.options.accept_step = false;
    m.options.step = 0.0147;  // the limit stated in the message
    CHECK(m.run().status == "ok");
    m.options.step.reset();
    CHECK(m.run().status == "ok");
}

TEST_CASE("an adaptive scheme is rejected if a force has internal state variables", "[studies][stable_step]")
{
    const BristleModel m;
    CHECK_THROWS_WITH(m.run("ida-rp"),
                      "run: ida-rp chooses its own steps; bristle 'brush' has internal state variables and "
                      "needs a fixed-step scheme");
    CHECK_FALSE(tests::fs::exists(m.directory()));
}

TEST_CASE("a killed run with --accept-step is resumed and gives the result of an uninterrupted run",
          "[studies][stable_step][resume]")
{
    BristleModel m;
    m.options.step = 0.016;
    m.options.end = 30;
    m.options.accept_step = true;
    REQUIRE(m.run().status == "ok");
    const std::string whole = tests::read(m.in / "out/trajectory.csv");

    m.options.checkpoint = 1e-9;  // after each step
    tests::fs::remove_all(m.directory());
    const pid_t child = fork();
    if (child == 0) {
        // The signal SIGXFSZ ends the process when trajectory.csv reaches this length.
        const rlimit none{0, 0}, most{1 << 13, 1 << 13};
        setrlimit(RLIMIT_CORE, &none);
        setrlimit(RLIMIT_FSIZE, &most);
        std::signal(SIGXFSZ, SIG_DFL);
        try {
            m.run();
        } catch (...) {
        }
        _exit(0);
    }
    REQUIRE(child > 0);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));
    REQUIRE(WTERMSIG(status) == SIGXFSZ);
    REQUIRE(tests::fs::file_size(m.in / "out/trajectory.csv") == 1 << 13);
    REQUIRE(whole.size() > 10 << 13);

    m.options.accept_step = false;
    m.options.resume = true;
    m.options.checkpoint = 0;
    const run::RunResult resumed = m.run();
    CHECK(resumed.status == "ok");
    CHECK(resumed.resumed_at > 50);
    CHECK(tests::read(m.in / "out/trajectory.csv") == whole);
}

TEST_CASE("a study rejects steps above the stability limit of a force", "[studies][stable_step]")
{
    const tests::Scratch in;
    for (const char* message : {"rolling_ball: the step 0.02 s is above", "--steps sets others"})
        tests::check_refused(
            in, {"study", "convergence", "--problem", "rolling_ball", "--steps", "2e-2,1e-2", "--no-plot"}, 2,
            message);
}

namespace {

/// A slider of 2 kg with a damper of 4e4 N s/m: explicit integrators that extrapolate velocities need steps
/// below m/c = 5e-5 s, the others below 1e-4 s
const char* const damped_slider = R"({"hilda_model": 1, "name": "m", "end": 0.05, "gravity": [9.81, 0, 0],
 "bodies": [{"name": "slider", "mass": 2, "inertia": [1, 1, 1], "r": [1, 0, 0]}],
 "constraints": [{"name": "rail", "type": "translational", "body_i": "ground", "body_j": "slider",
   "s_bar_p_i": [1, 0, 0], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}],
 "forces": [{"name": "damper", "type": "spring-damper", "body_i": "ground", "body_j": "slider",
   "stiffness": 10, "damping": 4e4, "free_length": 1}]})";

}  // namespace

TEST_CASE("a step above the stability limit of a damper is rejected for explicit integrators",
          "[studies][stable_step]")
{
    const tests::Scratch in;
    tests::write(in / "m.json", damped_slider);
    const auto run = [&](const std::string& scheme, const std::vector<std::string>& more = {}) {
        return tests::call(in,
                           tests::with({"run", "m.json", "--integrator", scheme, "--output", scheme}, more));
    };
    for (const auto& [scheme, limit] : {std::pair("rA-half-1-momentum", "4.999e-05 s"),
                                        {"rA-half-1", "9.999e-05 s"},
                                        {"rA-rattle", "9.999e-05 s"}}) {
        const tests::Ended refused = run(scheme);
        CHECK(refused.code == 2);
        const bool has_rule = scheme != std::string("rA-rattle");
        CHECK(refused.err == std::string("hilda: error: run: the step 0.001 s is above ") + limit +
                                 ", the stability limit of force 'damper' in an explicit step" +
                                 (has_rule ? R"(; "implicit": true in this force removes this limit)" : "") +
                                 "; --accept-step accepts it\n");
        CHECK(run(scheme, {"--step", "4.99e-5", "--quiet"}).code == 0);
    }
    CHECK_THAT(
        run("rA-half-1-momentum", {"--force", "--accept-step"}).err,
        Catch::StartsWith("hilda: warning: the step 0.001 s is above 4.999e-05 s, the stability limit"));
    for (const char* scheme : {"rA-full-1-exact", "rp-bdf2", "ida-rp"}) CHECK(run(scheme).code == 0);
}

TEST_CASE("an implicit damper has no stability limit with the integrators that evaluate it implicitly",
          "[studies][stable_step][implicit]")
{
    const tests::Scratch in;
    std::string model = damped_slider;
    model.insert(model.find(R"("stiffness")"), R"("implicit": true, )");
    tests::write(in / "m.json", model);
    const auto last = [&](const std::string& scheme) {
        const tests::Ended run =
            tests::call(in, {"run", "m.json", "--integrator", scheme, "--output", scheme, "--quiet"});
        CHECK(run.code == 0);
        CHECK(run.err.empty());
        const std::string rows = tests::read(in / (scheme + "/trajectory.csv"));
        const std::string row = rows.substr(rows.rfind('\n', rows.size() - 2) + 1);
        return std::stod(row.substr(row.find(',') + 1));  // the column slider.rx
    };
    // m g/c = 4.9e-4 m/s, reached after m/c = 5e-5 s
    const double exact = 1 + 2 * 9.81 / 4e4 * (0.05 - 5e-5);
    for (const char* scheme : {"rA-half-1", "rA-half-1-kick", "rA-half-1-momentum"})
        CHECK(last(scheme) == Approx(exact).margin(1e-6));
    CHECK(last("ida-rp") == Approx(exact).margin(1e-8));
    CHECK(tests::call(in, {"run", "m.json", "--integrator", "rA-rattle", "--output", "rattle"}).code == 2);
    CHECK_THAT(tests::call(in, {"check", "m.json"}).out, Catch::Contains("--integrator rA-half-1-momentum"));
}

TEST_CASE(
    "a run with implicit springs, implicit friction and a contact constraint is resumed to the last digit",
    "[studies][stable_step][implicit][resume]")
{
    const tests::Scratch in;
    tests::write(in / "m.json", R"({"hilda_model": 1, "name": "m", "end": 0.4,
 "bodies": [{"name": "ball", "mass": 0.5, "inertia": [0.002, 0.002, 0.002], "r": [0.6363961030678928, 0, -0.6363961030678928]}],
 "forces": [{"name": "strut", "type": "spring-damper", "body_i": "ground", "body_j": "ball", "s_bar_p_i": [0.2, 0.5, 0.3],
   "s_bar_q_j": [0, 0.05, 0], "stiffness": 500, "damping": 5, "free_length": 1.15, "force": "-3*ldot^3", "implicit": true}],
 "contacts": [{"name": "ball-bowl", "body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.1},
   "surface_j": {"type": "sphere", "radius": 1, "concave": true}, "normal": {"type": "constraint"},
   "friction": {"law": "implicit", "mu_s": 0.3, "mu_k": 0.2, "K_E": 1e5}}]})");
    const std::string scheme = GENERATE(std::string("rA-half-1"), std::string("rA-half-1-momentum"));
    const std::string solver = GENERATE(std::string("klu"), std::string("condensed"));
    const auto run = [&](const std::string& output, const std::vector<std::string>& more) {
        const tests::Ended ended =
            tests::call(in, tests::with({"run", "m.json", "--integrator", scheme, "--step", "2e-3",
                                         "--linear-solver", solver, "--output", output, "--quiet"},
                                        more));
        CAPTURE(scheme, solver, ended.err);
        CHECK(ended.code == 0);
    };
    const std::string name = scheme + solver;
    run(name, {});
    run(name + "parts", {"--end", "0.15"});
    run(name + "parts", {"--end", "0.4", "--resume"});
    const std::string whole = tests::read(in / (name + "/trajectory.csv"));
    CHECK(whole.size() > 20000);
    CHECK(tests::read(in / (name + "parts/trajectory.csv")) == whole);
}

TEST_CASE("a run that fails above the stability limit of a force names the force", "[studies][stable_step]")
{
    const tests::Scratch in;
    tests::write(in / "m.json", R"({"hilda_model": 1, "name": "m", "end": 1,
 "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 0.1, 1], "r": [0, 1, 0], "r_dot": [0, 0, 1], "omega": [1, 0, 0]}],
 "constraints": [{"name": "pin", "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, -1, 0],
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}],
 "forces": [{"name": "brake", "type": "torsion-spring", "body_i": "ground", "body_j": "bar", "axis_bar_i": [1, 0, 0],
   "axis_bar_j": [1, 0, 0], "stiffness": 0, "damping": 1e4, "free_angle": 0}]})");
    // The moment of inertia about the pin is 2 kg m^2.
    const tests::Ended forced = tests::call(in, {"run", "m.json", "--accept-step", "--output", "a"});
    CHECK(forced.code == 4);
    CHECK_THAT(forced.err,
               Catch::Contains("the step is above 0.0002 s, the stability limit of force 'brake'") &&
                   !Catch::Contains("singular constraints"));
}

TEST_CASE("check names an integrator that suits the model, and the reason", "[studies][check]")
{
    const tests::Scratch in;
    tests::write(in / "m.json", damped_slider);
    const auto recommended = [&](const std::string& model) {
        const auto facts = nlohmann::json::parse(tests::call(in, {"check", model, "--json"}).out);
        const std::string scheme = facts["recommended_integrator"], reason = facts["recommendation"];
        CHECK_THAT(tests::call(in, {"check", model}).out,
                   Catch::Contains("recommended         --integrator " + scheme + "; " + reason + '\n'));
        return scheme + ": " + reason;
    };
    CHECK_THAT(recommended("double_pendulum"), Catch::StartsWith("rA-half-1-momentum: smooth motion"));
    CHECK_THAT(recommended("slider_crank"), Catch::StartsWith("rA-rkmk-4: no degrees of freedom"));
    CHECK_THAT(recommended("ball_in_bowl"), Catch::StartsWith("rA-half-1-momentum: contact constraints"));
    CHECK_THAT(recommended("rolling_ball"), Catch::StartsWith("rA-half-1-momentum: compliant contacts"));
    CHECK_THAT(recommended("m.json"), Catch::StartsWith("rp-bdf2: stiff: force 'damper' limits the step"));

    // A contact whose limit is below the default step; run refuses the step with the number that check
    // prints.
    tests::write(in / "ball.json", R"({"hilda_model": 1, "name": "ball", "end": 1,
        "bodies": [{"name": "ball", "mass": 5, "inertia": [0.08, 0.08, 0.08], "r": [0, 0, 0.2]}],
        "contacts": [{"name": "floor", "body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.2},
                      "surface_j": {"type": "plane", "normal": [0, 0, 1]}, "normal": {"type": "hertz", "E_star": 1e7},
                      "friction": {"mu_s": 0.25, "mu_k": 0.2, "K_E": 2e5}}]})");
    CHECK_THAT(recommended("ball.json"), Catch::StartsWith("rA-half-1-momentum: compliant contacts"));
    const auto facts = nlohmann::json::parse(tests::call(in, {"check", "ball.json", "--json"}).out);
    const double limit = facts["contacts"][0]["stable_step"];
    CHECK(limit < 1e-3);
    const auto refuses = [&](double part_of_limit) {
        return tests::call(
                   in, {"run", "ball.json", "--end", std::to_string(100 * part_of_limit * limit), "--step",
                        std::to_string(part_of_limit * limit), "--output", std::to_string(part_of_limit)})
                   .code == 2;
    };
    CHECK(refuses(1.02));
    CHECK_FALSE(refuses(0.98));
}
