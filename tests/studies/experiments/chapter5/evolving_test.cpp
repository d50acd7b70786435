// SPDX-License-Identifier: GPL-3.0-or-later
/// Evolving contacts in the program: runs, checks, columns and studies.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "run/columns/contact_rows.hpp"
#include "run/columns/invariants.hpp"
#include "studies/problems/evolving_reference.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using lie::Vec3;
using nlohmann::ordered_json;

namespace {

Vec3 vector(const CsvRow& row, const std::string& name, const std::array<const char*, 3>& of)
{
    return {number(row, name + of[0]), number(row, name + of[1]), number(row, name + of[2])};
}

}  // namespace

TEST_CASE("a run writes the contact points and the forces of an evolving contact", "[studies][evolving]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"run", "rolling_ball_in_bowl", "--integrator", "rA-half-1-momentum", "--step", "5e-3",
                  "--tolerance", "1e-14", "--end", "1", "--interval", "0.1", "--reactions", "--output", "a"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK(ended.err.empty());
    CHECK_THAT(ended.out, Contains("1 contact, 3 degrees of freedom") && Contains("ball-bowl: F_N from "));
    const auto rows = csv(in / "a/trajectory.csv");
    REQUIRE(rows.size() == 11);
    CHECK(number(rows[0], "ball-bowl.Ff_y") > 0);  // friction acts up the slope and accelerates the rotation
    for (const CsvRow& row : rows) {
        const Vec3 r = vector(row, "ball.", {"rx", "ry", "rz"}),
                   C = vector(row, "ball-bowl.", {"Cx", "Cy", "Cz"}),
                   a_i = vector(row, "ball-bowl.", {"ai_x", "ai_y", "ai_z"}),
                   a_j = vector(row, "ball-bowl.", {"aj_x", "aj_y", "aj_z"}),
                   F_f = vector(row, "ball-bowl.", {"Ff_x", "Ff_y", "Ff_z"});
        lie::Mat3 A;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                A(i, j) = number(row, "ball.A" + std::to_string(i + 1) + std::to_string(j + 1));
        CHECK((r + A * a_i - C).norm() < 1e-14);
        CHECK((a_j - C).norm() < 1e-14);  // the bowl is the ground
        CHECK(number(row, "constraint_norm") < 8e-15);
        CHECK(number(row, "ball-bowl.lambda_N") < 1e-12);
        // the constraint force is the normal force plus a tangential friction force
        const Vec3 n = (r - C).normalized(), F = vector(row, "ball.", {"Fx", "Fy", "Fz"});
        CHECK((F - number(row, "ball-bowl.F_N") * n - F_f).norm() < 1e-11);
        CHECK(std::abs(F_f.dot(n)) < 1e-12);
    }
    const ordered_json summary = ordered_json::parse(read(in / "a/summary.json"));
    REQUIRE(summary["contacts"].size() == 1);
    CHECK(summary["contacts"][0]["name"] == "ball-bowl");
    CHECK(summary["contacts"][0]["normal_force_least"].get<double>() == Approx(9.1552).epsilon(1e-4));
    CHECK(summary["contacts"][0]["normal_force_most"].get<double>() ==
          Approx(number(rows[10], "ball-bowl.F_N")));
    CHECK(summary["invariants"]["constraint_norm"].get<double>() < 8e-15);
    CHECK(summary["model"]["degrees_of_freedom"] == 3);
}

TEST_CASE("check reports the rows, unknowns and curvatures of an evolving contact",
          "[studies][evolving][check]")
{
    const Scratch in;
    const Ended words = call(in, {"check", "ball_in_bowl"});
    CAPTURE(words.err);
    CHECK(words.code == 0);
    CHECK_THAT(words.out, Contains("contact constraints 1, of rank 1\n") &&
                              Contains("  ball-bowl         7 rows, 6 unknowns\n") &&
                              Contains("normal force 9.155246513 N") && Contains("curvatures 2, 2 and -0.") &&
                              Contains("--integrator rA-half-1-momentum"));
    const ordered_json facts = ordered_json::parse(
        call(in, {"check", "rolling_ball_in_bowl", "--json", "--normal-rows", "fixed-xy"}).out);
    const ordered_json& contact = facts["evolving_contacts"][0];
    CHECK(contact["rows"] == 7);
    CHECK(contact["velocity_rows"] == 2);
    CHECK(contact["unknowns"] == 6);
    CHECK(contact["normal_rows"] == "fixed-xy");
    CHECK(contact["normal_force"].get<double>() > 0);
    CHECK(contact["normal"][1].get<double>() == Approx(-0.3592106040535498).epsilon(1e-12));
    CHECK(contact["least_relative_curvature"].get<double>() > 0.5);
    CHECK(facts["condition"].get<double>() < 1e3);
    CHECK(facts["degrees_of_freedom"] == 3);
    CHECK(facts["recommended_integrator"] == "rA-half-1-momentum");
    CHECK_THAT(call(in, {"check", "double_pendulum"}).out,
               !Contains("contact constraints") &&
                   Contains("recommended         --integrator rA-half-1-momentum; smooth motion"));
}

TEST_CASE("integrators list the features that they take and reject others", "[studies][evolving]")
{
    const Scratch in;
    const ordered_json all = ordered_json::parse(call(in, {"integrators", "--json"}).out);
    for (const ordered_json& s : all) {
        INFO(s["name"]);
        const lie::Scheme& scheme = lie::scheme(s["name"]);
        for (const lie::FeatureText& f : lie::all_features()) {
            const auto listed = std::count(s["supports"].begin(), s["supports"].end(), std::string(f.key));
            CHECK(listed == (scheme.supports.contains(f.feature) ? 1 : 0));
        }
    }
    CHECK_THAT(call(in, {"integrators"}).out, Contains("contacts, implicit_friction, rolling,") &&
                                                  Contains("rolling: rolling without slip") &&
                                                  Contains("default is rA-half-1-momentum"));
    const Ended refused = call(in, {"run", "ball_in_bowl", "--integrator", "rp-half-1"});
    CHECK(refused.code == 3);
    CHECK_THAT(refused.err, Contains("does not support evolving contacts; integrators that do are") &&
                                Contains("rA-half-1-momentum"));
    CHECK(call(in, {"run", "rattleback", "--integrator", "rA-rattle"}).code == 3);
    CHECK_FALSE(fs::exists(in / "out"));
}

TEST_CASE("normal rows along x and y give the same loop as tangent rows", "[studies][evolving]")
{
    const Scratch in;
    const auto loop = [&](const std::string& rows, const std::string& output) {
        return call(in, {"run", "ball_in_bowl", "--normal-rows", rows, "--set", "/bodies/0/r=[0, 0, -1.5]",
                         "--set", "/bodies/0/r_dot=[0, 14, 0]", "--integrator", "rA-half-1-momentum",
                         "--step", "5e-3", "--end", "1", "--output", output});
    };
    const Ended tangent = loop("tangent", "a"), fixed = loop("fixed-xy", "b");
    CAPTURE(tangent.err, fixed.err);
    CHECK(tangent.code == 0);
    CHECK(fixed.code == 0);
    const ordered_json summary = ordered_json::parse(read(in / "b/summary.json"));
    const ordered_json of_tangent = ordered_json::parse(read(in / "a/summary.json"));
    CHECK(summary["invariants"]["energy_end"].get<double>() ==
          Approx(of_tangent["invariants"]["energy_end"].get<double>()).epsilon(1e-10));
    CHECK(summary["counters"]["newton_iterations"].get<long>() >
          of_tangent["counters"]["newton_iterations"].get<long>());
    CHECK(summary["model"]["set"].back() == "/contacts/0/normal/rows=fixed-xy");
    CHECK(ordered_json::parse(read(in / "b/model.json"))["contacts"][0]["normal"]["rows"] == "fixed-xy");

    CHECK_THAT(call(in, {"run", "double_pendulum", "--normal-rows", "tangent"}).err,
               Contains("--normal-rows applies to contacts whose normal is a constraint; model "
                        "double_pendulum has none"));
    CHECK(call(in, {"run", "ball_in_bowl", "--normal-rows", "xy"}).code == 2);
}

TEST_CASE("a run warns of a tensile normal force", "[studies][evolving]")
{
    const Scratch in;
    // without the bilateral constraint the ball would leave the dome
    write(in / "dome.json", R"({"hilda_model": 1, "name": "dome", "end": 1,
 "bodies": [{"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0, 0, 1.5], "r_dot": [5, 0, 0]}],
 "contacts": [{"name": "ball-dome", "body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.5},
  "surface_j": {"type": "sphere", "radius": 1}, "normal": {"type": "constraint"}}]})");
    const Ended ended = call(in, {"run", "dome.json", "--output", "a"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.err, Contains("contact 'ball-dome': the normal force is tensile, up to "));
    CHECK_THAT(read(in / "a/summary.json"), Contains("the normal force is tensile, up to"));
    CHECK_THAT(call(in, {"check", "dome.json"}).out, Contains("N, tensile"));
}

TEST_CASE("the summary lists the impacts of a bouncing ball", "[studies][evolving]")
{
    const Scratch in;
    // falls by 0.1 m; coefficient of restitution 0.5
    write(in / "m.json", R"({"hilda_model": 1, "name": "m", "end": 0.5, "gravity": [0, 0, -9.8],
 "bodies": [{"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0, 0, 0.6]}],
 "contacts": [{"name": "ball-floor", "body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.5},
  "surface_j": {"type": "plane"}, "normal": {"type": "constraint", "unilateral": true, "restitution": 0.5}}]})");
    CHECK_THAT(call(in, {"check", "m.json"}).out, Contains("contact inactive") && Contains("6\n"));
    const Ended ended = call(in, {"run", "m.json", "--integrator", "rA-half-1-momentum", "--step", "1e-2",
                                  "--reactions", "--output", "a"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const ordered_json summary = ordered_json::parse(read(in / "a/summary.json"));
    const ordered_json& events = summary["contact_events"];
    REQUIRE(events["count"].get<int>() >= 2);
    const double t = std::sqrt(2 * 0.1 / 9.8);  // the scheme integrates the parabola exactly
    CHECK(events["first"][0]["what"] == "impact");
    CHECK(events["first"][0]["t"].get<double>() == Approx(t).epsilon(1e-9));
    CHECK(events["first"][0]["speed"].get<double>() == Approx(9.8 * t).epsilon(1e-9));
    CHECK(events["first"][1]["t"].get<double>() == Approx(2 * t).epsilon(1e-9));
    const auto rows = csv(in / "a/trajectory.csv");
    CHECK(number(rows[5], "ball-floor.gap") == Approx(0.1 - 0.5 * 9.8 * 0.05 * 0.05));
    CHECK(number(rows[5], "ball-floor.F_N") == 0);
}

TEST_CASE("lambda_N above a millionth of the normal force means that the normals differ",
          "[studies][evolving]")
{
    CHECK(run::ContactExtremes{.F_N_least = 1, .F_N_most = 10, .lambda_N = 1.1e-5}.normals_differ());
    CHECK(run::ContactExtremes{.F_N_least = -10, .F_N_most = 1, .lambda_N = 1.1e-5}.normals_differ());
    CHECK_FALSE(run::ContactExtremes{.F_N_least = 1, .F_N_most = 10, .lambda_N = 0.9e-5}.normals_differ());
}

TEST_CASE("the reference solution of a contact agrees with an integration with small steps",
          "[studies][evolving]")
{
    for (const char* name :
         {"ball_in_bowl_xy", "rolling_ball_in_bowl_xy", "wobbling_ellipsoid", "rattleback"}) {
        INFO(name);
        const studies::Problem p = studies::problem(name);
        dae::Description d = dae::read_model(p.model, name);
        dae::start(d);
        const std::vector<double> at = {0.02};
        const lie::State by_reference = studies::evolving_reference(d, at).row[0],
                         by_steps =
                             studies::run_with_small_steps(d, at, lie::scheme("rA-rkmk-4"), 1e-3).row[0];
        CHECK((by_reference.body[0].r - by_steps.body[0].r).norm() < 1e-10);
        CHECK((by_reference.body[0].A - by_steps.body[0].A).norm() < 1e-9);
        CHECK((by_reference.alpha - by_steps.alpha).norm() < 1e-9);
        const contact::EvolvingContact& c =
            *run::evolving_contacts(*d.model)[0];  // λ depends on the tangents
        const auto from_reference = c.multipliers(d.model->arguments(c, by_reference), by_reference.lambda),
                   from_steps = c.multipliers(d.model->arguments(c, by_steps), by_steps.lambda);
        CHECK(from_reference.F_N == Approx(from_steps.F_N).epsilon(1e-8));
        CHECK((from_reference.friction - from_steps.friction).norm() < 1e-7);
    }
}

TEST_CASE("the evolving-contact study passes its criteria", "[studies][evolving]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "evolving-contact", "--problem", "planar,planar-roll", "--end",
                                  "1", "--check", "--no-plot", "--output", "a", "--expect", "r=0+-1"});
    CAPTURE(ended.err, ended.out);
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("F_N(0) [N], planar"));
    const auto rows = csv(in / "a/planar.csv");
    CHECK(rows.size() > 200);
    CHECK(number(rows[0], "F_N") == Approx(9.1552965).epsilon(1e-5));
    CHECK(csv(in / "a/study.csv").size() == 2 * 2 * 2);
    CHECK(call(in, {"study", "evolving-contact", "--problem", "bowl"}).code == 2);
    CHECK(call(in, {"study", "energy", "--normal-rows", "tangent"}).code == 2);
}

TEST_CASE(
    "a step above the stability limit of the contact friction is rejected and the message states the limit",
    "[studies][evolving][friction]")
{
    const Scratch in;
    const auto run = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = {"run",          "braked_ball_in_bowl",
                                          "--set",        "/contacts/0/friction/eta_r=0",
                                          "--integrator", "rA-half-1-momentum",
                                          "--end",        "0.5",
                                          "--output",     "a"};
        words.insert(words.end(), more.begin(), more.end());
        return call(in, words);
    };
    const Ended refused = run({"--step", "5e-3"});
    CHECK(refused.code == 2);
    // (sqrt(d² + 4 k) - d)/k, d = 350, k = 35000: 4.64e-3 s, rounded down, so that the printed step is stable
    CHECK_THAT(refused.err, Contains("the step 0.005 s is above 0.004638 s, the stability limit of contact "
                                     "'ball-bowl'"));
    CHECK_FALSE(fs::exists(in / "a"));
    CHECK(run({"--step", "4.638e-3", "--interval", "0"}).code == 0);
    const Ended forced = run({"--step", "5e-3", "--force", "--accept-step"});
    CHECK(forced.code == 0);
    CHECK_THAT(forced.err, Contains("0.004638 s"));

    const Ended checked = call(in, {"check", "braked_ball_in_bowl"});
    CHECK(checked.code == 0);
    CHECK_THAT(checked.out,
               Contains("friction 0 N, stable up to 0.00326 s") && Contains("forces              0"));
    const ordered_json facts =
        ordered_json::parse(call(in, {"check", "braked_ball_in_bowl", "--json"}).out)["evolving_contacts"][0];
    CHECK(facts["friction"] == "tracked");
    CHECK(facts["stable_step"].get<double>() == Approx(3.26e-3).epsilon(2e-3));
    CHECK(facts["fallback"] == false);
    CHECK(facts["fallback_stable_step"].is_null());

    // Implicit friction takes no degree of freedom.
    const std::vector<std::string> implicit = {
        "check", "braked_ball_in_bowl", "--set",
        R"(/contacts/0/friction={"law": "implicit", "mu_s": 0.25, "K_E": 1e4})"};
    const Ended with_implicit = call(in, implicit);
    CHECK_THAT(with_implicit.out, Contains("0 with 0 rows of rank 0") && Contains("1, of rank 1") &&
                                      Contains("2 rows of implicit friction") &&
                                      Contains("degrees of freedom  5"));
}

TEST_CASE("a run writes the friction of an evolving contact", "[studies][evolving][friction]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"run", "braked_ball_in_bowl", "--integrator", "rA-half-1-momentum", "--step", "2.5e-3",
                  "--end", "1", "--interval", "0.05", "--reactions", "--vtk", "0.5", "--output", "a"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto rows = csv(in / "a/trajectory.csv");
    REQUIRE(rows.size() == 21);
    for (const CsvRow& row : rows) {
        const Vec3 F_f = vector(row, "ball-bowl.", {"Ff_x", "Ff_y", "Ff_z"}),
                   C = vector(row, "ball-bowl.", {"Cx", "Cy", "Cz"}),
                   r = vector(row, "ball.", {"rx", "ry", "rz"});
        const double F_N = number(row, "ball-bowl.F_N");
        CHECK(std::abs(F_f.dot((r - C).normalized())) < 1e-9);
        CHECK(F_f.norm() < 0.25 * F_N);
        if (number(row, "t") > 0.1) CHECK(F_f.norm() > 0);
        // the acceleration is that of weight, normal force and friction
        const Vec3 residual =
            vector(row, "ball.", {"ax", "ay", "az"}) - Vec3(0, 0, -9.81) - F_N * (r - C).normalized() - F_f;
        if (number(row, "t") > 0.1)
            CHECK(residual.norm() < 0.05);  // F_f is evaluated at the nodes, the scheme uses half steps
    }
    CHECK_THAT(read(in / "a/vtk/run-000001.vtp"), Contains("\"rolling\""));
}

TEST_CASE("a contact that switches to its fallback is an event and the run continues",
          "[studies][evolving][friction]")
{
    const Scratch in;
    // a superquadric of exponent 4 has zero curvature on its axes; the block rolls there from the side
    const std::string block = R"({"type": "superquadric", "semi_axes": [0.3, 0.3, 0.2], "exponent": 4})";
    const auto model = [&](const std::string& pose, const std::string& fallback) {
        return R"({"hilda_model": 1, "name": "m", "end": 1,
 "bodies": [{"name": "block", "mass": 1, "inertia": [0.02, 0.02, 0.03], )" +
               pose + R"(}],
 "contacts": [{"name": "block-floor", "body_i": "block", "body_j": "ground", "surface_i": )" +
               block + R"(, "surface_j": {"type": "plane"}, "normal": {"type": "constraint")" + fallback +
               R"(}, "friction": {"mu_s": 0.3, "K_E": 1e4}}]})";
    };
    const std::string
        rolls = R"("r": [0, 0, 0.3], "axis_angle": [0.8, 0.6, 0, 0.5])",
        lies = R"("r": [0, 0, 0.2])",
        fallback =
            R"(, "unilateral": true, "fallback": {"type": "hooke", "stiffness": 1e5, "restitution": 0.2})";
    const auto run = [&](const std::string& text) {
        write(in / "m.json", text);
        return call(in, {"run", "m.json", "--integrator", "rA-half-1-momentum", "--step", "5e-4",
                         "--reactions", "--force", "--output", "a"});
    };
    const Ended alone = run(model(rolls, R"(, "unilateral": true)"));
    CAPTURE(alone.err);
    CHECK(alone.code == io::exit_code::numerical_failure);
    const Ended ended = run(model(rolls, fallback));
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const ordered_json events = ordered_json::parse(read(in / "a/summary.json"))["contact_events"];
    REQUIRE(events["count"] == 2);  // it falls first, until the contact closes
    CHECK(events["first"][0]["what"] == "closing");
    CHECK(events["first"][1]["what"] == "fallback");
    CHECK(events["first"][1]["contact"] == "block-floor");
    const double t = events["first"][1]["t"].get<double>();
    CHECK(t > 0);
    CHECK(t < 1);
    for (const CsvRow& row : csv(in / "a/trajectory.csv"))
        if (number(row, "t") > t + 0.01 && number(row, "block-floor.gap") < -1e-6)
            CHECK(number(row, "block-floor.F_N") > 0);  // normal force of the fallback law

    write(in / "m.json", model(lies, fallback));
    CHECK_THAT(call(in, {"check", "m.json"}).out, Contains("of the fallback, which is active"));
    const Ended from_start = run(model(lies, fallback));
    REQUIRE(from_start.code == 0);
    const ordered_json first = ordered_json::parse(read(in / "a/summary.json"))["contact_events"]["first"][0];
    CHECK(first["what"] == "fallback");
    CHECK(first["t"] == 0);
    CHECK(run(model(lies, "")).code == 3);
}

TEST_CASE("the evolving-order study distinguishes first from second order", "[studies][evolving]")
{
    const Scratch in;
    const auto study = [&](const std::string& scheme, const std::string& order) {
        return call(
            in, {"study", "evolving-order", "--problem", "ball_in_bowl", "--integrator", scheme, "--steps",
                 "1e-2,5e-3", "--end", "1", "--no-plot", "--json", "--expect", "order=" + order + "+-0.05",
                 "--expect", "order_alpha=" + order + "+-0.05", "--expect", "order_F_N=" + order + "+-0.05"});
    };
    CHECK(study("rA-half-1", "1").code == 0);
    CHECK(study("rA-half-1-momentum", "2").code == 0);
    CHECK(study("rA-half-1-momentum", "1").code == io::exit_code::expectation_failed);
    CHECK(call(in, {"study", "evolving-order", "--problem", "double_pendulum"}).code == 2);
}

TEST_CASE("the evolving-friction study passes its criteria and rejects the step of the dissertation",
          "[studies][evolving][friction]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"study", "evolving-friction", "--problem", "eta-0.3", "--check", "--no-plot", "--vtk", "3",
                  "--output", "a", "--expect", "rest=-0.325+-1e-3"});
    CAPTURE(ended.err, ended.out);
    CHECK(ended.code == 0);
    const auto rows = csv(in / "a/study.csv");
    REQUIRE(rows.size() == 1);
    CHECK(number(rows[0], "bound") == Approx(2.55e-3).epsilon(5e-3));
    CHECK(csv(in / "a/curves.csv").size() == 4001 + 1001);
    CHECK(fs::exists(in / "a/vtk/eta-0.3-rA-half-1-momentum-2.5e-3-000002.vtp"));

    const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
        check_refused(in, with({"study", "evolving-friction"}, more), 2, message);
    };
    refused({"--steps", "5e-3"}, "eta-0: the step 0.005 s is above 0.00464 s");
    refused({"--problem", "eta-0.1", "--steps", "4e-3"}, "eta-0.1: the step 0.004 s is above 0.00326 s");
    refused({"--problem", "eta-0.4"}, "unknown scene");
    CHECK(call(in, {"study", "evolving-friction", "--problem", "eta-0", "--end", "2.5", "--no-plot",
                    "--output", "b", "--expect", "F_f=1.007+-5e-3"})
              .code == 0);
}

TEST_CASE("the studies of evolving contacts write frames", "[studies][evolving][vtk]")
{
    const Scratch in;
    CHECK(call(in, {"study", "evolving-contact", "--problem", "planar-roll", "--end", "0.5", "--vtk", "4",
                    "--no-plot", "--output", "a"})
              .code == 0);
    CHECK(fs::exists(in / "a/planar-roll-rA-half-1.pvd"));
    CHECK(fs::exists(in / "a/vtk/planar-roll-rA-half-1-momentum-000003.vtp"));
    CHECK_FALSE(fs::exists(in / "a/vtk/planar-roll-rA-half-1-momentum-000004.vtp"));
    CHECK(call(in, {"study", "evolving-contact", "--vtk", "2", "--json"}).code == 2);
}
