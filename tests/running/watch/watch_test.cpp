// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs that the watch ends or warns about, and the entries of summary.json.

#include "run/watch/watch.hpp"

#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "studies/framework/problem.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/resumed_run.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using nlohmann::ordered_json;
using run::Watch;

namespace {

struct Result {
    Ended ended;
    ordered_json summary;

    const ordered_json& watch() const { return summary["watch"]; }
};

Result run_of(const Scratch& in, const std::string& model, const std::vector<std::string>& options)
{
    write(in / "m.json", model);
    Result r{.ended = call(in, with({"run", "m.json", "--force", "--accept-step"}, options)), .summary = {}};
    if (fs::exists(in / "out/m/summary.json")) r.summary = summary(in / "out/m");
    return r;
}

/// The same without --force, into an empty folder
Result careful_run(const Scratch& in, const std::string& model, const std::vector<std::string>& options)
{
    fs::remove_all(in / "out");
    write(in / "m.json", model);
    Result r{.ended = call(in, with({"run", "m.json"}, options)), .summary = {}};
    if (fs::exists(in / "out/m/summary.json")) r.summary = summary(in / "out/m");
    return r;
}

std::vector<std::string> momentum(const std::string& step)
{
    return {"--integrator", "rA-half-1-momentum", "--step", step, "--interval", "0.01"};
}

/// A free body that turns about its x axis at this speed [rad/s]
std::string spinning(double speed)
{
    return R"({"hilda_model": 1, "name": "m", "end": 0.1, "gravity": [0, 0, 0],
 "bodies": [{"name": "rotor", "mass": 1, "inertia": [1, 2, 2.5], "r": [0, 0, 0], "omega": [)" +
           std::to_string(speed) + ", 0, 0]}]}";
}

/// A ball of 0.1 kg and radius 0.05 m that is thrown upwards from a floor
std::string thrown_ball(double speed, double end)
{
    return R"({"hilda_model": 1, "name": "m", "end": )" + std::to_string(end) + R"(, "bodies": [
 {"name": "ball", "mass": 0.1, "inertia": [1e-4, 1e-4, 1e-4], "r": [0, 0, 0.05], "r_dot": [0, 0, )" +
           std::to_string(speed) + R"(]}],
 "contacts": [{"name": "floor", "body_i": "ball", "body_j": "ground",
   "surface_i": {"type": "sphere", "radius": 0.05}, "surface_j": {"type": "plane"},
   "normal": {"type": "hertz", "E_star": 1e8}}]})";
}

/// Pushes a body in the direction of its velocity, and claims to be passive
class Accelerating final : public dae::Force {
public:
    void add(const lie::State& x, lie::Loads& out) const override { out.F[0] += 0.5 * x.body[0].rdot; }
    bool is_passive() const override { return true; }
    int last_body() const override { return 0; }
};

/// Pushes a body against its velocity, and claims not to dissipate
class Braking final : public dae::Force {
public:
    explicit Braking(double c) : c(c) {}
    void add(const lie::State& x, lie::Loads& out) const override { out.F[0] -= c * x.body[0].rdot; }
    bool is_passive() const override { return true; }
    bool is_dissipative() const override { return false; }
    int last_body() const override { return 0; }

private:
    const double c;
};

/// How a run of a body of 1 kg with 1 m/s and a force ends: the name of its first finding, or the failure
template <class Force>
std::string end_of_run(const Force& force, const std::string& name, double end, Watch::Action action)
{
    dae::Model model;
    model.gravity.setZero();
    model.add({.name = "b", .m = 1, .J_bar = lie::Mat3::Identity()});
    model.load(force);
    lie::State x;
    x.body.resize(1);
    x.body[0].rdot = {1, 0, 0};
    dae::start(model, x);
    const lie::TimeGrid grid = lie::TimeGrid::over(end, 1e-3);
    const lie::Scheme& scheme = lie::scheme(name);
    const auto integrator = scheme.make(model, {});
    Watch watch(model, x, *integrator, scheme, grid, action);
    lie::Observer* observers[] = {&watch};
    try {
        lie::march(x, *integrator, grid, observers);
    } catch (const lie::NodeFailure& failure) {
        return failure.status + ": " + failure.what();
    }
    return watch.findings().empty() ? "ok" : watch.findings().front().name;
}

}  // namespace

TEST_CASE("a passive model whose energy rises ends with energy_created", "[run][watch]")
{
    const auto end = [](const std::string& scheme, Watch::Action action) {
        return end_of_run(Accelerating(), scheme, 0.2, action);
    };
    // T = exp(t)/2 J: above its lowest value by 1 % of itself from t = 0.01 s on
    CHECK_THAT(end("rA-half-1-momentum", Watch::Action::stop), Catch::StartsWith("energy_created: "));
    CHECK(end("rA-half-1-momentum", Watch::Action::record) == "energy_rises");
    CHECK(end("rA-half-1", Watch::Action::stop) == "energy_rises");  // its energy drifts anyway
    CHECK_THAT(end("rA-half-1", Watch::Action::strict), Catch::StartsWith("energy_rises: "));
}

TEST_CASE("a model that loses energy without dissipation has a finding", "[run][watch]")
{
    const auto end = [](double c, Watch::Action action) {
        return end_of_run(Braking(c), "rA-half-1-momentum", 1, action);
    };
    // T = exp(-2 c t)/2 J: 60 % are lost at c = 0.46
    CHECK(end(0.46, Watch::Action::stop) == "energy_lost");
    CHECK(end(0.04, Watch::Action::stop) == "ok");
    CHECK_THAT(end(0.46, Watch::Action::strict),
               Catch::StartsWith("energy_lost: the energy falls by ") &&
                   Catch::Contains("and nothing in the model dissipates energy; reduce the step"));
}

TEST_CASE("the checks of a node do not allocate memory", "[run][watch][allocation]")
{
    dae::Description d = dae::read_model(studies::problem("rolling_ball").model, "rolling_ball");
    dae::start(d);
    const lie::Scheme& scheme = lie::scheme("rA-half-1-momentum");
    const auto integrator = scheme.make(*d.model, {});
    Watch watch(*d.model, d.x, *integrator, scheme, lie::TimeGrid::over(1, 1e-4), Watch::Action::stop);
    lie::State x = d.x;
    const long taken = allocations_during([&] {
        for (int n = 0; n < 100; ++n) watch.accepted(x, n, 1);
    });
    if (counts_allocations) CHECK(taken == 0);
    CHECK(watch.record().energy.evaluations == 100);
}

TEST_CASE("a large rotation in one step is a warning, with --strict a failure", "[run][watch]")
{
    const Scratch in;
    const Result slow = run_of(in, spinning(299), {});
    CHECK(slow.ended.code == 0);
    CHECK(slow.ended.err.empty());
    CHECK(slow.watch()["largest_turn"]["value"].get<double>() == Approx(0.299).epsilon(1e-9));
    CHECK(slow.watch()["largest_turn"]["of"] == "rotor");

    const Result fast = run_of(in, spinning(301), {});
    CHECK(fast.ended.code == 0);
    CHECK_THAT(fast.ended.err, Contains("body 'rotor' turns by 0.301 rad in one step"));
    CHECK(fast.summary["model"]["warnings"].size() == 1);

    const Result strict = run_of(in, spinning(301), {"--strict"});
    CHECK(strict.ended.code == 4);
    CHECK(strict.summary["status"] == "large_turn");
    CHECK(strict.summary["counters"]["rows"] == 1);  // the start, at which it is found
}

TEST_CASE("a failed step after a node that --strict refuses ends with the status of the step and a summary",
          "[run][watch]")
{
    const Scratch in;
    // At t = 0.2 s, ω h = 0.47 rad. The next step turns by 26 rad.
    const std::string accelerated = R"({"hilda_model": 1, "name": "m", "end": 1, "gravity": [0, 0, 0],
 "bodies": [{"name": "wheel", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}],
 "forces": [{"type": "torque", "body": "wheel", "frame": "global", "components": [0, 0, "exp(40*t)*0.06"]}]})";
    const Result r = run_of(in, accelerated, {"--integrator", "rA-rkmk-4", "--step", "0.1", "--strict"});
    CHECK(r.ended.code == 4);
    CHECK(r.summary["status"] == "step_too_large");
    CHECK(r.summary["counters"]["rows"] == 3);
    CHECK_THAT(r.ended.err, Contains("body 'wheel' turns by 0.473 rad in one step at t = 0.2 s"));
}

TEST_CASE("the work of a driver that is at rest at first is part of the balance of energy", "[run][watch]")
{
    const Scratch in;
    // An arm of 1 kg with the angle (t - 3 s)³ about its end. It has no degree of freedom: D = 0.
    write(in / "m.json", R"({"hilda_model": 1, "name": "m", "end": 4.5,
 "bodies": [{"name": "arm", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0.5, 0, 0]}],
 "constraints": [
  {"name": "hinge", "type": "revolute", "body_i": "ground", "body_j": "arm", "s_bar_q_j": [-0.5, 0, 0],
   "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]},
  {"name": "motor", "type": "hinge-driver", "body_i": "ground", "body_j": "arm", "axis_bar_i": [0, 1, 0],
   "axis_bar_j": [0, 1, 0], "angle": "max(0, t - 3)^3"}]})");
    REQUIRE(call(in, {"run", "m.json", "--output", "whole"}).code == 0);
    const ordered_json whole = summary(in / "whole");
    CHECK(whole["model"]["warnings"].empty());
    const ordered_json& energy = whole["watch"]["energy"];
    CHECK(energy["passive"] == false);
    const double W = energy["work_of_drivers"];
    const double rate = 3 * 1.5 * 1.5, angle = 1.5 * 1.5 * 1.5;
    CHECK(W == Approx(0.5 * (0.1 + 0.25) * rate * rate - 9.81 * 0.5 * std::sin(angle)).epsilon(1e-4));
    CHECK(std::abs(energy["dissipated"].get<double>()) < 1e-4 * W);

    REQUIRE(call(in, {"run", "m.json", "--output", "part", "--end", "3.5"}).code == 0);
    REQUIRE(call(in, {"run", "m.json", "--output", "part", "--resume", "--end", "4.5"}).code == 0);
    CHECK(summary(in / "part")["watch"] == whole["watch"]);
}

TEST_CASE("a contact that becomes stiffer than at the start ends the run before energy is created",
          "[run][watch]")
{
    const Scratch in;
    const Result r = careful_run(in, thrown_ball(10, 2.5), momentum("1e-3"));
    CHECK(r.ended.code == 4);
    CHECK(r.summary["status"] == "unstable_step");
    CHECK_THAT(r.ended.err,
               Contains("the step 0.001 s is above the stability limit of contact 'floor' at t = 2.0"));
    const double kinetic = 0.5 * 0.1 * 10 * 10;
    CHECK(r.watch()["energy"]["rise"].get<double>() < 0.01 * kinetic);

    const Result fine = careful_run(in, thrown_ball(10, 2.5), momentum("2e-5"));
    CHECK(fine.ended.code == 0);
    CHECK(fine.ended.err.empty());
    CHECK(std::abs(fine.summary["invariants"]["energy_drift"].get<double>()) < 0.01 * kinetic);

    const Result forced = run_of(in, thrown_ball(10, 2.5), momentum("1e-3"));
    CHECK_THAT(forced.ended.err, Contains("above the stability limit of contact 'floor'"));
}

TEST_CASE("balls that would pass through each other end the run", "[run][watch]")
{
    const Scratch in;
    const std::string balls =
        R"({"hilda_model": 1, "name": "m", "end": 0.01, "gravity": [0, 0, 0], "bodies": [
 {"name": "a", "mass": 1, "inertia": [1e-3, 1e-3, 1e-3], "r": [-0.1, 0, 0], "r_dot": [50, 0, 0]},
 {"name": "b", "mass": 1, "inertia": [1e-3, 1e-3, 1e-3], "r": [0.1, 0, 0], "r_dot": [-50, 0, 0]}],
 "contacts": [{"name": "ab", "body_i": "a", "body_j": "b",
   "surface_i": {"type": "sphere", "radius": 0.05}, "surface_j": {"type": "sphere", "radius": 0.05},
   "normal": {"type": "hertz", "E_star": EEE}}]})";
    const auto with_modulus = [&](const std::string& E) {
        std::string text = balls;
        return text.replace(text.find("EEE"), 3, E);
    };
    const Result soft =
        careful_run(in, with_modulus("1e6"),
                    {"--integrator", "rA-half-1-momentum", "--step", "1e-6", "--interval", "1e-4"});
    CHECK(soft.ended.code == 4);
    CHECK(soft.summary["status"] == "overlap_too_large");
    CHECK_THAT(soft.ended.err, Contains("contact 'ab': the surfaces overlap by 0.5"));
    CHECK(soft.summary["model"]["warnings"].empty());  // the message of the failure is not repeated

    // the largest overlap follows from the energy: 8/15 E* sqrt(R/2) d^(5/2) = m v²
    const double E = 1e10, d = std::pow(2500 / (8. / 15 * E * std::sqrt(0.025)), 0.4);
    const Result hard =
        careful_run(in, with_modulus("1e10"),
                    {"--integrator", "rA-half-1-momentum", "--step", "1e-7", "--interval", "1e-4"});
    CHECK(hard.ended.code == 0);
    CHECK(hard.watch()["largest_overlap"]["value"].get<double>() == Approx(d / 0.05).epsilon(1e-3));
    CHECK(hard.watch()["largest_overlap"]["of"] == "contact 'ab'");
}

TEST_CASE("energy that a scheme of first order gains is a warning with the reason", "[run][watch]")
{
    const Scratch in;
    // a free body that tumbles about its intermediate axis
    const std::string tumbling = R"({"hilda_model": 1, "name": "m", "end": 20, "gravity": [0, 0, 0],
 "bodies": [{"name": "box", "mass": 1, "inertia": [1, 2, 3], "r": [0, 0, 0], "omega": [0.1, 10, 0.1]}]})";
    const Result drifts = run_of(in, tumbling, {"--integrator", "rA-half-1", "--step", "2e-3"});
    CHECK(drifts.ended.code == 0);
    CHECK_THAT(drifts.ended.err, Contains("the energy of rA-half-1 drifts with an error of order 1"));
    CHECK(drifts.watch()["energy"]["rise"].get<double>() > 1);

    const Result strict = run_of(in, tumbling, {"--integrator", "rA-half-1", "--step", "2e-3", "--strict"});
    CHECK(strict.ended.code == 4);
    CHECK(strict.summary["status"] == "energy_rises");

    const Result keeps = run_of(in, tumbling, {"--integrator", "rA-half-1-momentum", "--step", "2e-3"});
    CHECK(keeps.ended.code == 0);
    CHECK(keeps.ended.err.empty());
    const ordered_json& energy = keeps.watch()["energy"];
    CHECK(energy["passive"] == true);
    CHECK(energy["kinetic_most"].get<double>() == Approx(0.5 * (0.01 + 200 + 0.03)).epsilon(1e-3));
    CHECK(energy["rise"].get<double>() < energy["step_error"].get<double>());
}

TEST_CASE("the record of the watch of a resumed run is that of an uninterrupted one", "[run][watch][resume]")
{
    const Scratch in;
    write(in / "m.json", thrown_ball(1, 1));
    const std::vector<std::string> run = with({"run", "m.json"}, momentum("1e-4"));
    REQUIRE(call(in, with(run, {"--output", "whole"})).code == 0);
    REQUIRE(call(in, with(run, {"--output", "part", "--end", "0.4"})).code == 0);
    REQUIRE(call(in, with(run, {"--output", "part", "--resume", "--end", "1"})).code == 0);
    CHECK(summary(in / "whole")["watch"] == summary(in / "part")["watch"]);
    CHECK(summary(in / "whole")["watch"]["largest_overlap"]["value"].get<double>() > 1e-3);
}
