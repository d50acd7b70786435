// SPDX-License-Identifier: GPL-3.0-or-later
/// Models that keep redundant rows: singular configurations, multipliers of minimum norm, messages.

#include "dae/joints.hpp"
#include "dae/kinematics.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using Catch::Contains;

namespace {

/// Row of N four-bar windows with N + 1 upright cranks and N couplers of 1 m and 1 kg. The joints are added
/// in a random order; seed 0 is the natural order.
void four_bars(Model& model, State& x, int N, unsigned seed = 0)
{
    const Vec3 J_bar(1. / 600, 1. / 12, 1. / 12);
    const Mat3 upright = tests::matrix({0, -1, 0}, {1, 0, 0}, {0, 0, 1});
    std::vector<std::function<void()>> joints;
    const auto joint = [&](const std::string& name, int i, const Vec3& at_i, int j, const Vec3& at_j) {
        joints.emplace_back([=, &model] { model.constrain(name, revolute(i, at_i, Z, j, at_j, Z)); });
    };
    for (int k = 0; k <= N; ++k) {
        tests::add_body(model, x, "crank " + std::to_string(k), 1, J_bar, k * X + 0.5 * Y, upright, -0.5 * X,
                        Z);
        joint("A" + std::to_string(k), ground, k * X, k, -0.5 * X);
    }
    for (int k = 0; k < N; ++k) {
        const int coupler = tests::add_body(model, x, "coupler " + std::to_string(k), 1, J_bar,
                                            (k + 0.5) * X + Y, Mat3::Identity(), -X);
        joint("B" + std::to_string(k), k, 0.5 * X, coupler, -0.5 * X);
        joint("C" + std::to_string(k), coupler, 0.5 * X, k + 1, 0.5 * X);
    }
    std::mt19937 random(seed);
    if (seed > 0) std::shuffle(joints.begin(), joints.end(), random);
    for (const auto& add : joints) add();
    model.gravity = -9.81 * Y;
    model.keep_redundant = true;
}

/// Angle of the cranks of four_bars() after a time t [s]: a pendulum, by 10000 steps of the classical
/// Runge-Kutta method
double crank_angle(int N, double t)
{
    const double factor = -9.81 * (0.5 * (N + 1) + N) / ((N + 1) / 3. + N);
    constexpr int steps = 10000;
    const double h = t / steps;
    double phi = std::numbers::pi / 2, w = 1;
    const auto a = [&](double angle) { return factor * std::cos(angle); };
    for (int n = 0; n < steps; ++n) {
        const double v1 = w, a1 = a(phi), v2 = w + h / 2 * a1, a2 = a(phi + h / 2 * v1), v3 = w + h / 2 * a2,
                     a3 = a(phi + h / 2 * v2), v4 = w + h * a3, a4 = a(phi + h * v3);
        phi += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
        w += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return phi;
}

State last(const Model& model, const State& x, const std::string& scheme, double t_end, double h)
{
    const auto integrator = lie::scheme(scheme).make(model, {});
    return lie::march(x, *integrator, lie::TimeGrid::over(t_end, h, t_end)).row.back();
}

/// Distance of crank 0 from its exact position at 1 s; the mechanism is flat at 0.714 s
double error_after_crossing(const std::string& scheme, double h, unsigned seed = 0)
{
    Model model;
    State x;
    four_bars(model, x, 2, seed);
    start(model, x);
    const double phi = crank_angle(2, 1);
    return (last(model, x, scheme, 1, h).body[0].r - 0.5 * Vec3(std::cos(phi), std::sin(phi), 0)).norm();
}

/// A model of the text of a file in which a bar hangs on a pin, with other keys
std::string bar_on_pin(const std::string& keys)
{
    return R"({"hilda_model": 1, "name": "pendulum", )" + keys + R"(
"bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0.5, 0]}],
"constraints": [{"name": "pin", "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, -0.5, 0],
                 "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}]})";
}

}  // namespace

TEST_CASE("all rows are kept, and the report has the rank", "[dae][redundant]")
{
    Model model;
    State x;
    four_bars(model, x, 2);
    const StartReport report = start(model, x);
    CHECK(report.rows == 35);
    CHECK(model.rows() == 35);
    CHECK(report.rank == 29);
    CHECK(report.redundant == 6);
    CHECK(report.degrees_of_freedom == 1);
    CHECK(report.dropped.empty());
    CHECK(model.dropped_rows().empty());
}

TEST_CASE("a mechanism with all rows passes its flat configuration with the order of the scheme",
          "[dae][redundant]")
{
    for (const char* scheme : {"rA-half-1-momentum", "rA-rattle"}) {
        const double coarse = error_after_crossing(scheme, 8e-3), fine = error_after_crossing(scheme, 4e-3);
        INFO(scheme << " " << coarse << " " << fine);
        CHECK(fine < 1e-4);
        CHECK(std::log2(coarse / fine) > 1.8);
        CHECK(std::log2(coarse / fine) < 2.8);
    }
    CHECK(error_after_crossing("rA-rkmk-4", 1e-2) < 1e-6);
}

TEST_CASE("a start in a singular configuration follows the branch of the initial velocities",
          "[dae][redundant]")
{
    // Two windows, flat, with the parallel branch of four_bars(): all cranks rotate with 1 rad/s.
    Model model;
    State x;
    four_bars(model, x, 2);
    for (int b = 0; b < model.bodies(); ++b) {
        lie::Motion& body = x.body[b];
        const bool crank = b < 3;
        body.r = Vec3(crank ? b + 0.5 : b - 3 + 1.5, 0, 0);
        body.A = Mat3::Identity();
        body.rdot = (crank ? 0.5 : 1) * Y;
    }
    CHECK(start(model, x).rank == 27);
    x = last(model, x, "rA-half-1-momentum", 0.1, 4e-3);
    CHECK(x.body[0].A(1, 0) > 0.02);
    for (const int b : {1, 2}) CHECK((x.body[b].A - x.body[0].A).norm() < 1e-6);
    CHECK(model.largest_residual(x).value < 1e-6);
}

TEST_CASE("the motion does not depend on the order of the joints", "[dae][redundant]")
{
    Model natural;
    State x;
    four_bars(natural, x, 2);
    start(natural, x);
    const State expected = last(natural, x, "rA-half-1-momentum", 1, 4e-3);
    for (const unsigned seed : {1U, 2U, 3U}) {
        Model model;
        State y;
        four_bars(model, y, 2, seed);
        start(model, y);
        const State found = last(model, y, "rA-half-1-momentum", 1, 4e-3);
        for (size_t b = 0; b < found.body.size(); ++b)
            CHECK((found.body[b].r - expected.body[b].r).norm() < 1e-8);
    }
}

TEST_CASE("multipliers of redundant rows are those of minimum norm, and the accelerations are exact",
          "[dae][redundant]")
{
    Model model;
    State x;
    four_bars(model, x, 2);
    start(model, x);
    x = last(model, x, "rA-rkmk-4", 0.5, 1e-2);  // away from the symmetric start
    const int m = model.rows(), n = 6 * model.bodies();
    lie::Rows rows = model.pattern();
    model.variation(x, rows);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(m, n);
    for (int k = 0; k < m; ++k)
        for (int e = rows.start[k]; e < rows.start[k + 1]; ++e)
            C.row(k).segment<6>(6 * rows.entry[e].body) << rows.entry[e].r.transpose(),
                rows.entry[e].pi.transpose();
    Eigen::VectorXd by_M(n), f(n), a(n), gamma(m);
    lie::Loads loads(model.bodies());
    model.loads(x, loads);
    model.gamma(x, gamma);
    for (int b = 0; b < model.bodies(); ++b) {
        const lie::Motion& body = x.body[b];
        by_M.segment<3>(6 * b).setConstant(1 / model.mass().m[b]);
        by_M.segment<3>(6 * b + 3) = model.mass().J_bar[b].diagonal().cwiseInverse();
        f.segment<6>(6 * b) << loads.F[b], loads.tau_bar(b, model.mass().J_bar[b], body.omega_bar);
        a.segment<6>(6 * b) << body.rddot, body.omegadot_bar;
    }
    // In the scaled variables μ = D^½ λ the solution of minimum norm is that of the pseudo-inverse.
    const Eigen::MatrixXd S = C * by_M.asDiagonal() * C.transpose();
    const Eigen::VectorXd by_sqrt_D = S.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = by_sqrt_D.asDiagonal() * S * by_sqrt_D.asDiagonal();
    const Eigen::VectorXd g = by_sqrt_D.asDiagonal() * (C * by_M.cwiseProduct(f) - gamma);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> pseudo_inverse;
    pseudo_inverse.setThreshold(1e-8);
    pseudo_inverse.compute(scaled);
    CHECK(pseudo_inverse.rank() == 29);
    const Eigen::VectorXd lambda = by_sqrt_D.cwiseProduct(pseudo_inverse.solve(g));
    CHECK((x.lambda - lambda).norm() < 1e-7 * lambda.norm());
    CHECK((a - by_M.cwiseProduct(f - C.transpose() * lambda)).norm() < 1e-8 * a.norm());
    CHECK((C * a - gamma).norm() < 1e-8 * a.norm());
}

TEST_CASE("a mechanism without redundant rows has the same motion if it keeps its rows", "[dae][redundant]")
{
    State end[2];
    for (const bool keep : {false, true}) {
        Model model;
        State x;
        tests::slider_crank_bodies(model, x);
        model.constrain("pin", revolute(ground, Vec3(0, 0.1, 0.12), X, 0, O, X));
        model.constrain("ball", spherical(1, Vec3(-0.15, 0, 0), 0, Vec3(0, 0.08, 0)));
        model.keep_redundant = keep;
        start(model, x, {.fix_initial = true});
        end[keep] = last(model, x, "rA-half-1-momentum", 0.2, 1e-3);
    }
    for (size_t b = 0; b < end[0].body.size(); ++b)
        CHECK((end[0].body[b].r - end[1].body[b].r).norm() < 1e-7);
}

TEST_CASE("steps across a singular configuration allocate no memory", "[dae][redundant][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted: a sanitizer replaces the allocator");
        return;
    }
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::redundant) || s.name == "rA-full-1-exact")
            continue;  // KLU chooses new pivots
        Model model;
        State x;
        four_bars(model, x, 2);
        start(model, x);
        const auto integrator = s.make(model, {});
        lie::March march(x, *integrator, 4e-3);
        for (int n = 0; n < 5; ++n) march.advance({});
        INFO(s.name);
        CHECK(tests::allocations_during([&] {
                  for (int n = 0; n < 195; ++n) march.advance({});
              }) == 0);
    }
}

TEST_CASE("integrators and solvers that cannot keep redundant rows are refused by name", "[dae][redundant]")
{
    Model model;
    State x;
    four_bars(model, x, 1);
    start(model, x);
    for (const lie::Scheme& s : lie::schemes()) {
        INFO(s.name);
        if (s.supports.contains(lie::Feature::redundant))
            CHECK_NOTHROW(s.make(model, {}));
        else
            CHECK_THROWS_WITH(s.make(model, {}), Contains(s.name) && Contains("redundant rows"));
    }
    CHECK_THROWS_WITH(lie::scheme("rA-rattle").make(model, {.linear_solver = lie::LinearSolver::klu}),
                      Contains("condensed linear solver"));
    CHECK_THROWS_WITH(Kinematics(model), Contains("independent rows"));
}

TEST_CASE("rows that contradict each other are rejected if all rows are kept", "[dae][redundant]")
{
    for (const double length : {0.5, 0.6}) {  // of a brace from the middle of crank 0 to its bearing
        Model model;
        State x;
        four_bars(model, x, 1);
        model.constrain("brace", distance(0, O, ground, O, length));
        if (length == 0.5)
            CHECK_NOTHROW(start(model, x, {.fix_initial = true}));
        else
            CHECK_THROWS_AS(start(model, x, {.fix_initial = true}), lie::NumericalFailure);
    }
}

TEST_CASE("redundant of a model file is drop or keep", "[dae][redundant]")
{
    CHECK_FALSE(read_model(bar_on_pin(""), "file").model->keep_redundant);
    CHECK_FALSE(read_model(bar_on_pin(R"("redundant": "drop",)"), "file").model->keep_redundant);
    const Description kept = read_model(bar_on_pin(R"("redundant": "keep",)"), "file");
    CHECK(kept.model->keep_redundant);
    CHECK_THAT(kept.text, Contains(R"("redundant": "keep")"));
    CHECK(read_model(kept.text, "text").model->keep_redundant);
    CHECK_THAT(read_model(bar_on_pin(""), "file").text, !Contains("redundant"));
    CHECK_THROWS_WITH(read_model(bar_on_pin(R"("redundant": "keeps",)"), "file"),
                      Contains("file:1:") && Contains("(/redundant)") && Contains("did you mean 'keep'?") &&
                          Contains("keeps"));
}

TEST_CASE("of a cam in a plane the redundant row of the guide is dropped, and two equal curves are refused",
          "[dae][redundant]")
{
    // A circle of radius R whose centre is e beside the shaft, and a rod with a point on it
    constexpr double e = 0.03, R = 0.1, W = 2 * std::numbers::pi;
    const auto height = [](double t) {
        return e * std::sin(W * t) + std::sqrt(R * R - std::pow(e * std::cos(W * t), 2)) + 0.2;
    };
    const std::string curve =
        R"json({"name": "track", "type": "point-on-curve", "body_i": "rod", "body_j": "cam",
        "s_bar_p_i": [0, 0, -0.2], "curve": ["0.03+0.1*cos(s)", 0, "0.1*sin(s)"], "s": 1.8754889808102941})json";
    const auto model = [&](const std::string& more) {
        return R"json({"hilda_model": 1, "name": "cam", "gravity": [0, 0, 0], "bodies": [
         {"name": "cam", "mass": 1, "inertia": [0.01, 0.01, 0.01], "r": [0, 0, 0], "omega": [0, "-2*pi", 0]},
         {"name": "rod", "mass": 0.2, "inertia": [0.001, 0.001, 0.001], "r": [0, 0, 0.2953939201416946],
          "r_dot": [0, 0, 0.18849555921538758]}], "constraints": [
         {"name": "shaft", "type": "revolute", "body_i": "ground", "body_j": "cam", "axis_bar_i": [0, 1, 0],
          "axis_bar_j": [0, 1, 0]},
         {"name": "drive", "type": "hinge-driver", "body_i": "ground", "body_j": "cam", "axis_bar_i": [0, -1, 0],
          "axis_bar_j": [0, -1, 0], "angle": "2*pi*t"},
         {"name": "guide", "type": "translational", "body_i": "ground", "body_j": "rod",
          "s_bar_q_j": [0, 0, -0.2953939201416946], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}, )json" +
               curve + more + "]}";
    };
    Description cam = read_model(model(""), "cam.json");
    const StartReport report = dae::start(cam);
    CHECK(report.degrees_of_freedom == 0);
    REQUIRE(report.dropped.size() == 1);
    CHECK_THAT(report.dropped[0], Contains("constraint 'guide'"));
    for (const char* name : {"rA-half-1", "rA-half-2", "rA-rkmk-4"}) {
        INFO(name);
        const auto integrator = lie::scheme(name).make(*cam.model, {});
        for (const auto& row : lie::march(cam.x, *integrator, lie::TimeGrid::over(0.4, 1e-3, 0.1)).row)
            CHECK(row.body[1].r[2] == Approx(height(row.t)).margin(1e-9));
    }

    std::string second = ", " + curve;
    second.replace(second.find("track"), 5, "again");
    Description twice = read_model(model(second), "cam.json");
    try {
        dae::start(twice);
        FAIL("accepted");
    } catch (const lie::NumericalFailure& failure) {
        CHECK(failure.status == "contact_rank");
        CHECK_THAT(failure.what(),
                   Contains("'again'") &&
                       Catch::EndsWith("With \"redundant\": \"keep\" in the model file all rows are kept"));
    }
}
