// SPDX-License-Identifier: GPL-3.0-or-later
/// Index-1 equations compared with reference trajectories and closed forms; choice of the reference solution.

#include "reference/solvers/index1.hpp"

#include "dae/kinematics.hpp"
#include "reference/solvers/ida_solver.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "tests/reference/chains.hpp"
#include "tests/reference/reference_csv.hpp"
#include "tests/support/bristle.hpp"

#include <numbers>

using namespace hilda;
using namespace hilda::reference;
using tests::add_body;

namespace {

using std::numbers::pi;

std::vector<std::vector<dae::Reaction>> loads(const dae::Model& model, const lie::Trajectory& run)
{
    std::vector<std::vector<dae::Reaction>> all;
    for (const lie::State& x : run.row) all.push_back(dae::reactions(model, x));
    return all;
}

void check(const tests::Deviation& d, double tolerance)
{
    INFO(d);
    CHECK(d.largest() < tolerance);
}

void check_on_constraints(const dae::Model& model, const lie::Trajectory& run)
{
    for (const lie::State& x : run.row) {
        CHECK(model.largest_residual(x).value < 1e-13);
        CHECK(model.largest_velocity_residual(x).value < 1e-12);
        for (const lie::Motion& body : x.body) CHECK(lie::orthogonality_error(body.A) < 1e-14);
    }
}

}  // namespace

TEST_CASE("index 1 reproduces the reference trajectory of two spinning bars in space",
          "[reference][index1][acceptance]")
{
    dae::Model model;
    lie::State x;
    tests::ball_chain(2, model, x, [](lie::State& start) {
        start.body[0].rdot = Vec3(-0.5, -1, 0), start.body[0].omega_bar = Vec3(3, 0.5, -1);
        start.body[1].rdot = Vec3(-2, 0, 0), start.body[1].omega_bar = Vec3(-4, 1, 2);
    });
    auto reference = tests::references("x_n_pendulum_2_spin.csv");
    reference.erase(reference.begin() + 11,
                    reference.end());  // up to 1 s, to limit the time of a debug build
    const lie::Trajectory run = index1(model, x, tests::instants(reference));
    const tests::Deviation d = tests::deviation(run.row, reference);
    const double Q = tests::reaction_deviation(loads(model, run), reference);
    INFO(d << ", loads " << Q);
    CHECK(d.r < 1e-11);
    CHECK(d.A < 1e-11);
    CHECK(d.rdot < 1e-11);
    CHECK(d.omega_bar < 1e-11);
    CHECK(d.rddot < 1e-10);
    CHECK(d.omegadot_bar < 1e-10);
    CHECK(Q < 1e-11);
    check_on_constraints(model, run);
    for (const lie::State& y : run.row)
        CHECK(lie::energy(model, y) == Approx(lie::energy(model, x)).epsilon(1e-12).margin(1e-9));
}

TEST_CASE("index 1 and the equations in two angles give the same motion of the double pendulum",
          "[reference][index1]")
{
    const tests::DoublePendulum pendulum{.w = 0.1, .thetadot_1 = 1, .thetadot_2 = -2};
    dae::Model model;
    lie::State x;
    pendulum.build(model, x);
    const std::vector<double> instants = {0, 0.2, 0.5};
    const lie::Trajectory run = index1(model, x, instants);
    check(tests::deviation(run.row, pendulum.angles().at(instants).row), 1e-10);
    check_on_constraints(model, run);
}

TEST_CASE("index 1 keeps the motion of bars that hang straight in a plane", "[reference][index1]")
{
    dae::Model model;
    lie::State x;
    tests::ball_chain(3, model, x, [](lie::State&) {});
    const Vec3 e = -Vec3::UnitZ(), axis = e.cross(tests::slanting).normalized();
    const PlanarBar bar{.length = 2, .m = 39, .J = 13.008125};
    const PlanarChain chain{.bar = {bar, bar, bar}, .e = e, .axis = axis, .gravity = tests::slanting};
    const std::vector<double> instants = {0.3};
    lie::Trajectory run = index1(model, x, instants), exact = chain.at(instants);
    for (lie::State& y :
         exact.row)  // rotate the body frames of the chain about the bars to those of the model
        for (size_t b = 0; b < 3; ++b) {
            lie::Motion& m = y.body[b];
            const Mat3 turn = chain.at({0}).row[0].body[b].A.transpose() * x.body[b].A;
            m.A = m.A * turn;
            m.omega_bar = turn.transpose() * m.omega_bar;
            m.omegadot_bar = turn.transpose() * m.omegadot_bar;
        }
    check(tests::deviation(run.row, exact.row), 1e-10);
}

TEST_CASE("index 1 reproduces the closed forms of tops", "[reference][index1]")
{
    const std::vector<double> instants = {0, 0.3};
    SECTION("free and symmetric")
    {
        dae::Model model;
        lie::State x;
        const Vec3 J_bar(0.02, 0.02, 0.01);
        add_body(model, x, "top", 2, J_bar, {0, 1, 0}, lie::exp(Vec3(0, -0.32, 0)), {0.5, 0, 14}, {2, 0, 12});
        dae::start(model, x);
        const FreeTop top(J_bar, x.body[0], model.gravity);
        const lie::Trajectory run = index1(model, x, instants);
        tests::Deviation d;
        for (const lie::State& y : run.row) {
            lie::State exact = y;
            exact.body[0] = top.at(y.t);
            d.add(y, exact);
        }
        check(d, 1e-10);
    }
    SECTION("heavy, in steady precession")
    {
        const HeavyTop top{.m = 2, .J_1 = 0.0206, .J_3 = 0.04, .l = 0.1, .theta = std::acos(0.8), .Omega = 2};
        dae::Model model;
        lie::State x;
        const lie::Motion start = top.at(0);
        add_body(model, x, "top", top.m, {top.J_1, top.J_1, top.J_3}, start.r, start.A, start.rdot,
                 start.omega_bar);
        model.constrain("tip", dae::spherical(dae::ground, Vec3::Zero(), 0, {0, 0, -top.l}));
        dae::start(model, x);
        tests::Deviation d;
        for (const lie::State& y : index1(model, x, instants).row) {
            lie::State exact = y;
            exact.body[0] = top.at(y.t);
            d.add(y, exact);
        }
        check(d, 1e-9);
    }
    SECTION("free and asymmetric, with constant angular momentum")
    {
        dae::Model model;
        lie::State x;
        const Vec3 J_bar(0.02, 0.03, 0.04);
        add_body(model, x, "top", 2, J_bar, {0, 1, 0}, Mat3::Identity(), {0, 0, 0}, {4, 0, 5});
        dae::start(model, x);
        const Vec3 H = J_bar.cwiseProduct(x.body[0].omega_bar);
        for (const lie::State& y : index1(model, x, instants).row) {
            CHECK((y.body[0].omega_bar - asymmetric_top(J_bar, 4, 5, y.t)).norm() < 1e-11);
            CHECK((y.body[0].A * J_bar.cwiseProduct(y.body[0].omega_bar) - H).norm() < 1e-12 * H.norm());
        }
    }
}

TEST_CASE("index 1 passes the singular positions of a driver", "[reference][index1]")
{
    // A pendulum on a rotating crank, driven by a dot-product driver (singular twice per revolution) or by a
    // hinge driver (never singular).
    const auto build = [](bool by_hinge, dae::Model& model, lie::State& x) {
        const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();
        add_body(model, x, "crank", 1, {0.1, 0.1, 0.1}, O, Mat3::Identity(), O, {2 * pi, 0, 0});
        add_body(model, x, "bob", 1, {0.02, 0.02, 0.02}, {0, 0.3, -0.5}, Mat3::Identity(), {0, 0, 0.6 * pi});
        model.constrain("shaft", dae::revolute(dae::ground, O, X, 0, O, X));
        model.constrain("pin", dae::revolute(0, {0, 0.3, 0}, X, 1, {0, 0, 0.5}, X));
        if (by_hinge)
            model.constrain("motor", dae::hinge_driver(dae::ground, X, 0, X, dae::Driver("2*pi*t"), x));
        else
            model.constrain("motor", dae::DP1(dae::ground, Z, 0, Y, dae::Driver("sin(2*pi*t)")));
        dae::start(model, x);
    };
    const std::vector<double> instants = {0.25,
                                          0.5};  // one branch of the dot-product driver is singular there
    lie::Trajectory run[2];
    std::vector<std::vector<dae::Reaction>> load[2];
    for (const bool by_hinge : {false, true}) {
        dae::Model model;
        lie::State x;
        build(by_hinge, model, x);
        run[by_hinge] = index1(model, x, instants);
        load[by_hinge] = loads(model, run[by_hinge]);
        check_on_constraints(model, run[by_hinge]);
    }
    check(tests::deviation(run[0].row, run[1].row), 1e-9);
    CHECK(run[0].row[0].discrete_state != run[0].row[1].discrete_state);
    for (size_t k = 0; k < instants.size(); ++k)
        for (size_t b = 0; b < 2; ++b) {
            CHECK((load[0][k][b].F - load[1][k][b].F).norm() < 1e-9);
            CHECK((load[0][k][b].T - load[1][k][b].T).norm() < 1e-9);
        }
}

TEST_CASE("index 1 rejects fully driven models, continuous internal states and unordered instants",
          "[reference][index1]")
{
    dae::Model driven;
    lie::State x;
    tests::slider_crank(driven, x);
    dae::start(driven, x);
    CHECK_THROWS_WITH(index1(driven, x, {1.0}), Catch::Contains("dae::Kinematics"));

    dae::Model model;
    lie::State y;
    tests::DoublePendulum{}.build(model, y);
    CHECK_THROWS_WITH(index1(model, y, {0.01, 0}), Catch::Contains("ascend") && Catch::Contains("got 0"));

    model.load(tests::Bristle(0, 1, 1, 0.1));
    dae::start(model, y);
    CHECK_THROWS_WITH(index1(model, y, {0.01}), Catch::Contains("continuous internal states"));
    CHECK_THROWS_WITH(IdaSolver(model, {}).advance(y, 0.01), Catch::Contains("integrator with a fixed step"));
}

TEST_CASE("the reference solution of a driven mechanism is kinematic analysis",
          "[reference][reference_solution]")
{
    dae::Model model;
    lie::State x;
    tests::slider_crank(model, x);
    dae::start(model, x);
    const lie::Trajectory run = reference_solution(model, x, {0, 0.04});
    const lie::Trajectory kinematics = dae::Kinematics(model).run(x, 0.04, 1);
    check(tests::deviation(run.row, kinematics.row), 1e-9);
}

TEST_CASE("a closed form is used only if it is a solution of the model", "[reference][reference_solution]")
{
    const tests::DoublePendulum pendulum{.w = 0.1, .thetadot_1 = 1, .thetadot_2 = -2};
    dae::Model model;
    lie::State x;
    pendulum.build(model, x);
    const std::vector<double> instants = {0.01, 0.02};
    const lie::Trajectory exact = index1(model, x, instants);
    const auto is_index1_result = [&](const lie::Trajectory& run) {  // bitwise
        return run.row[1].body[1].r == exact.row[1].body[1].r && run.row[1].lambda == exact.row[1].lambda;
    };

    const PlanarChain chain = pendulum.angles();
    const lie::Trajectory right =
        reference_solution(model, x, instants, [&](const std::vector<double>& at) { return chain.at(at); });
    CHECK_FALSE(is_index1_result(right));
    check(tests::deviation(right.row, exact.row), 1e-11);
    for (size_t k = 0; k < instants.size(); ++k)
        CHECK((right.row[k].lambda - exact.row[k].lambda).norm() < 1e-11 * exact.row[k].lambda.norm());

    const std::pair<const char*, void (*)(PlanarChain&)> variants[] = {
        {"another mass", [](PlanarChain& c) { c.bar[1].m *= 1 + 1e-6; }},
        {"another length", [](PlanarChain& c) { c.bar[1].length *= 1 + 1e-6; }},
        {"another inertia", [](PlanarChain& c) { c.bar[0].J *= 1 + 1e-6; }},
        {"another start", [](PlanarChain& c) { c.bar[0].theta += 1e-6; }},
        {"another gravity", [](PlanarChain& c) { c.gravity.y() = 1e-5; }},
        {"a missing bar", [](PlanarChain& c) { c.bar.pop_back(); }},
        {"an invalid mass", [](PlanarChain& c) { c.bar[0].m = -1; }},
        {"a NaN", [](PlanarChain& c) { c.bar[0].thetadot = std::nan(""); }},
    };
    for (const auto& [what, change] : variants) {
        INFO(what);
        PlanarChain changed = chain;
        change(changed);
        bool called = false;
        CHECK(is_index1_result(reference_solution(model, x, instants, [&](const std::vector<double>& at) {
            called = true;
            return changed.at(at);
        })));
        CHECK(called);
    }
}
