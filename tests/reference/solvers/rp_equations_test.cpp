// SPDX-License-Identifier: GPL-3.0-or-later
/// Equations of motion in Euler parameters: Jacobian compared with finite differences, residual of consistent
/// states.

#include "reference/solvers/rp_equations.hpp"

#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "tests/reference/chains.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::reference;
using lie::Vec3;

namespace {

struct TestModel {
    const char* name;
    void (*build)(dae::Model&, lie::State&);
};

const TestModel test_models[] = {
    {"slider-crank",
     [](dae::Model& model, lie::State& x) {
         tests::slider_crank(model, x);
         dae::start(model, x);
     }},
    {"four-link",
     [](dae::Model& model, lie::State& x) {
         tests::four_link(model, x);
         dae::start(model, x);
     }},
    {"double pendulum",
     [](dae::Model& model, lie::State& x) {
         tests::DoublePendulum{.w = 0.1, .thetadot_1 = 1, .thetadot_2 = -2}.build(model, x);
     }},
    {"springs",
     [](dae::Model& model, lie::State& x) {
         tests::ball_chain(3, model, x, [&](lie::State& start) {
             start.body[0].rdot = Vec3(-0.5, -1, 0), start.body[0].omega_bar = Vec3(3, 0.5, -1);
             start.body[1].rdot = Vec3(-1, -2, 0);
             start.body[2].rdot = Vec3(-1, -2, 0);
             model.load(dae::SpringDamper(0, {0.1, 0.2, 0}, 2, {0, 0.3, 0.1}, 300, 40, 0.2));
             model.load(dae::SpringDamper(1, {0.5, 0, 0.2}, dae::ground, {1, 1, 0}, 120, 5, 0.1));
             model.load(dae::TorsionSpring(0, Vec3::UnitX(), 1, Vec3::UnitX(), 70, 3, 0.1, start));
         });
     }},
    {"bars of 10 km",
     [](dae::Model& model, lie::State& x) {
         constexpr double L = 1e4;
         const Vec3 X = Vec3::UnitX(), inertia = L * L / 12 * Vec3(1, 0.01, 1);
         tests::add_body(model, x, "a", 1, inertia, {0, L / 2, 0}, lie::Mat3::Identity(), {0, 0, 0.2 * L},
                         {0.4, 0, 0});
         tests::add_body(model, x, "b", 2, inertia, {0, 1.5 * L, 0}, lie::Mat3::Identity(), {0, 0, 0.4 * L});
         model.constrain("A", dae::revolute(dae::ground, Vec3::Zero(), X, 0, {0, -L / 2, 0}, X));
         model.constrain("B", dae::revolute(0, {0, L / 2, 0}, X, 1, {0, -L / 2, 0}, X));
         dae::start(model, x);
     }},
    {"hinge driver",
     [](dae::Model& model, lie::State& x) {
         const Vec3 X = Vec3::UnitX(), O = Vec3::Zero();
         tests::add_body(model, x, "crank", 1, {0.1, 0.2, 0.3}, O, lie::Mat3::Identity(), O, {2, 0, 0});
         tests::add_body(model, x, "bob", 1, {0.02, 0.03, 0.02}, {0, 0.3, -0.5}, lie::Mat3::Identity(),
                         {0, 0, 0.6});
         model.constrain("shaft", dae::revolute(dae::ground, O, X, 0, O, X));
         model.constrain("pin", dae::revolute(0, {0, 0.3, 0}, X, 1, {0, 0, 0.5}, X));
         model.constrain("motor", dae::hinge_driver(dae::ground, X, 0, X, dae::Driver("2*t + sin(t)*t"), x));
         dae::start(model, x, {.fix_initial = true});
     }},
};

}  // namespace

TEST_CASE("the Jacobian of the rp equations is the derivative of their residual", "[reference][rp]")
{
    tests::Random random(GENERATE(1u, 2u));
    for (const TestModel& c : test_models)
        for (const RpForm form : {RpForm::ggl, RpForm::baumgarte, RpForm::index1}) {
            dae::Model model;
            lie::State x;
            c.build(model, x);
            RpEquations equations(model, x, form);
            const int n = equations.size();
            Eigen::VectorXd y(n), ydot(n);
            equations.write(x, y, ydot);
            for (int k = 0; k < n; ++k) {
                if (equations.unknown_type(k) == RpEquations::UnknownType::mu) continue;
                y[k] += equations.unknown_type(k) == RpEquations::UnknownType::lambda
                            ? random.number(-3, 3)
                            : random.number(-0.1, 0.1);
                ydot[k] += random.number(-1, 1);
            }
            const double t = x.t + 0.03, c_j = 7;

            const lie::Klu& J = equations.jacobian(t, y, ydot, c_j);
            REQUIRE(J.size() == n);
            Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n), differences(n, n);
            for (int column = 0; column < n; ++column)
                for (int k = J.columns()[column]; k < J.columns()[column + 1]; ++k)
                    dense(J.rows()[k], column) = J.value[k];
            for (int column = 0; column < n; ++column)
                differences.col(column) = tests::derivative(
                    [&](double h) {
                        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, column);
                        Eigen::VectorXd F(n);
                        equations.residual(t, y + step, ydot + c_j * step, F);
                        return F;
                    },
                    1e-3);
            Eigen::Index row = 0, column = 0;
            const double deviation = (dense - differences).cwiseAbs().maxCoeff(&row, &column);
            INFO(c.name << ", form " << static_cast<int>(form) << ": deviation " << deviation << " of "
                        << dense.cwiseAbs().maxCoeff() << " in " << equations.name(static_cast<int>(row))
                        << ", column " << column << ": " << dense(row, column) << ", differences "
                        << differences(row, column));
            CHECK(deviation < 1e-8 * dense.cwiseAbs().maxCoeff());
        }
}

TEST_CASE("a consistent state satisfies the rp equations", "[reference][rp]")
{
    for (const TestModel& c : test_models)
        for (const RpForm form : {RpForm::ggl, RpForm::baumgarte, RpForm::index1}) {
            dae::Model model;
            lie::State x;
            c.build(model, x);
            RpEquations equations(model, x, form);
            Eigen::VectorXd y(equations.size()), ydot(equations.size()), F(equations.size());
            equations.write(x, y, ydot);
            equations.residual(x.t, y, ydot, F);
            const double size = x.lambda.cwiseAbs().maxCoeff();
            INFO(c.name << ", form " << static_cast<int>(form));
            CHECK(F.cwiseAbs().maxCoeff() < 1e-12 * std::max(1.0, size));

            lie::State back = x;
            equations.read(x.t, y, back);
            for (size_t b = 0; b < x.body.size(); ++b) {
                CHECK((back.body[b].A - x.body[b].A).norm() < 1e-14);
                CHECK((back.body[b].omega_bar - x.body[b].omega_bar).norm() <
                      1e-13 * (1 + x.body[b].omega_bar.norm()));
            }
        }
}

TEST_CASE("each equation of the residual has a name", "[reference][rp]")
{
    dae::Model model;
    lie::State x;
    tests::DoublePendulum{}.build(model, x);
    const RpEquations equations(model, x);
    CHECK(equations.name(7) == "translation of body 'bar_1'");
    CHECK(equations.name(14 + 13) == "rotation of body 'bar_2'");
    CHECK(equations.name(28 + 1) == "constraint 'first' row 2; bodies 'ground', 'bar_1', derivative in time");
    CHECK(equations.name(28 + 10) ==
          "unit length of the Euler parameters of body 'bar_1', derivative in time");
    CHECK(equations.name(equations.size() - 1) == "unit length of the Euler parameters of body 'bar_2'");
    CHECK(equations.unknown_type(27) == RpEquations::UnknownType::velocity);
    CHECK(equations.unknown_type(28) == RpEquations::UnknownType::lambda);
}
