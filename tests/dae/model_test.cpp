// SPDX-License-Identifier: GPL-3.0-or-later
/// The model: names, valid bodies, rejected input, reactions and energy.

#include "dae/model.hpp"

#include "dae/constraints/cd.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/joints.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using Catch::Contains;
using tests::Random;

namespace {

Body body(const std::string& name, double m = 1, const Mat3& J_bar = Mat3::Identity())
{
    return {.name = name, .m = m, .J_bar = J_bar};
}

Mat3 diagonal(double a, double b, double c) { return Vec3(a, b, c).asDiagonal(); }

}  // namespace

TEST_CASE("bodies are found by their names", "[dae][model]")
{
    Model model;
    CHECK(model.add(body("crank")) == 0);
    CHECK(model.add(body("rod")) == 1);
    CHECK(model.bodies() == 2);
    CHECK(model.find("rod") == 1);
    CHECK(model.find("ground") == ground);
    CHECK(model.body_name(0) == "crank");
    CHECK(model.body_name(ground) == "ground");
    CHECK_THROWS_WITH(model.find("slider"), Contains("no body") && Contains("'slider'"));
    CHECK_THROWS_WITH(model.add(body("rod")), Contains("same name") && Contains("'rod'"));
    CHECK_THROWS_AS(model.add(body("ground")), lie::InvalidInput);
    CHECK_THROWS_AS(model.add(body("")), lie::InvalidInput);
    CHECK(model.bodies() == 2);  // rejected bodies were not added
}

TEST_CASE("an invalid body is rejected with the reason and the value", "[dae][model]")
{
    Model model;
    CHECK_THROWS_WITH(model.add(body("b", -2)),
                      Contains("body 'b'") && Contains("mass") && Contains("got -2"));
    CHECK_THROWS_AS(model.add(body("b", 0)), lie::InvalidInput);
    CHECK_THROWS_AS(model.add(body("b", NAN)), lie::InvalidInput);
    CHECK_THROWS_AS(model.add(body("b", INFINITY)), lie::InvalidInput);
    CHECK_THROWS_WITH(model.add(body("b", 1, diagonal(1, 1, NAN))), Contains("finite"));
    CHECK_THROWS_WITH(model.add(body("b", 1, diagonal(1, 1, 0))), Contains("positive definite"));
    CHECK_THROWS_WITH(model.add(body("b", 1, diagonal(1, -1, 1))), Contains("positive definite"));
    CHECK_THROWS_WITH(model.add(body("b", 1, diagonal(1, 1, 2.1))), Contains("sum of the other two"));
    Mat3 skewed = Mat3::Identity();
    skewed(0, 1) = 0.1;
    CHECK_THROWS_WITH(model.add(body("b", 1, skewed)), Contains("symmetric") && Contains("0.1"));
    CHECK(model.bodies() == 0);

    model.add(body("rod", 1, diagonal(1e-6, 1, 1)));
    model.add(body("thin plate", 1, diagonal(1, 2, 3)));
    model.add(body("thin plate, ten digits", 1, diagonal(0.3333333333, 0.3333333333, 0.6666666667)));
    // the inequality holds for the principal moments, in any body frame
    const Mat3 R = Random(1).rotation();
    model.add(body("turned plate", 1, R * diagonal(1, 2, 2.99) * R.transpose()));
    CHECK_THROWS_AS(model.add(body("turned", 1, R * diagonal(1, 2, 3.01) * R.transpose())),
                    lie::InvalidInput);
    CHECK(model.bodies() == 4);
}

TEST_CASE("a constraint without two different existing bodies is rejected", "[dae][model]")
{
    Model model;
    model.add(body("crank"));
    model.add(body("rod"));
    CHECK_THROWS_WITH(model.constrain("pin", spherical(0, O, 2, O)), Contains("'pin'") && Contains("got 2"));
    CHECK_THROWS_WITH(model.constrain("pin", spherical(-2, O, 0, O)), Contains("got -2"));
    CHECK_THROWS_WITH(model.constrain("pin", spherical(1, O, 1, O)),
                      Contains("different") && Contains("'rod'"));
    CHECK_THROWS_AS(model.constrain("pin", spherical(ground, O, ground, O)), lie::InvalidInput);
    CHECK(model.rows() == 0);
    model.constrain("pin", spherical(ground, O, 0, O));
    CHECK_THROWS_WITH(model.constrain("pin", DP1(0, X, 1, Y)), Contains("same name") && Contains("'pin'"));
    CHECK(model.rows() == 3);
}

TEST_CASE("a constraint with modes that is no contact constraint is rejected", "[dae][model]")
{
    struct Latch final : Constraint {
        using Constraint::Constraint;
        Size size() const override { return {.position_rows = 1, .may_be_inactive = true}; }
        void phi(const Arguments&, double* out) const override { *out = 0; }
        void variation(const Arguments&, Derivatives&) const override {}
        void gamma(const Arguments&, double* out) const override { *out = 0; }
    };
    Model model;
    model.add(body("rod"));
    CHECK_THROWS_WITH(model.constrain("latch", std::make_unique<Latch>(ground, 0)),
                      Contains("constraint 'latch'") && Contains("ContactConstraint"));
    CHECK(model.general_constraints().empty());
}

TEST_CASE("the name of a row contains its constraint and its bodies", "[dae][model]")
{
    Model model;
    model.add(body("crank"));
    model.add(body("rod"));
    model.constrain("pin", revolute(ground, O, X, 0, Z, X));
    model.constrain("ball", spherical(0, -Z, 1, Z));
    CHECK(model.rows() == 8);
    CHECK(model.constraints() == 2);
    CHECK(model.row_name(1) == "constraint 'pin' row 2; bodies 'ground', 'crank'");
    CHECK(model.row_name(7) == "constraint 'ball' row 3; bodies 'crank', 'rod'");
    model.drop({5});
    CHECK(model.rows() == 7);
    CHECK(model.dropped_rows() == std::vector<int>{5});
    CHECK(model.row_name(5) == "constraint 'ball' row 2; bodies 'crank', 'rod'");
}

TEST_CASE("a model rejects a state with another number of bodies", "[dae][model]")
{
    Model model;
    model.add(body("bar"));
    model.constrain("unfit", DP1(ground, X, 0, X, 1.0));
    State x;
    CHECK_THROWS_WITH(model.prepare(x), Contains("got 0"));
    x.body.resize(1);
    try {
        model.prepare(x);
        FAIL("a singular DP1 was accepted");
    } catch (const ConstraintError& e) {
        CHECK(e.constraint == 0);
        CHECK_THAT(e.what(), Contains("constraint 'unfit' row 1") && Contains("parallel"));
    }
}

TEST_CASE("an orientation that is not a rotation is rejected", "[dae][model]")
{
    Model model;
    model.add(body("bar"));
    State x;
    x.body.resize(1);
    x.body[0].A = 2 * Mat3::Identity();
    CHECK_THROWS_WITH(model.prepare(x), Contains("body 'bar'") && Contains("rotation"));
    x.body[0].A = -Mat3::Identity();
    CHECK_THROWS_WITH(model.prepare(x), Contains("rotation"));
    x.body[0].A = Mat3::Constant(NAN);
    CHECK_THROWS_AS(model.prepare(x), lie::InvalidInput);
    x.body[0].A = Random(1).rotation();
    CHECK_NOTHROW(model.prepare(x));
}

TEST_CASE("phi, nu, gamma and the variation omit removed rows and the ground", "[dae][model]")
{
    Random random(GENERATE(range(1u, 6u)));
    Model model;
    model.add(body("a"));
    model.add(body("b"));
    const Vec3 c = random.vector(), s = random.vector(), q = random.vector();
    const Driver f("sin(3*t)");
    model.constrain("one", DP1(0, c, 1, s, f));
    model.constrain("two", CD(X, ground, s, 1, q));
    model.constrain("three", CD(c, 1, s, 0, q, f));
    model.drop({0});
    const State x = random.state(2);

    Eigen::VectorXd phi(2), nu(2), gamma(2);
    model.phi(x, phi), model.nu(x, nu), model.gamma(x, gamma);
    lie::Rows C = model.pattern();
    model.variation(x, C);
    const CD two(X, ground, s, 1, q), three(c, 1, s, 0, q, f);
    const Motion& a = x.body[0];
    const Motion& b = x.body[1];
    CHECK(phi[0] == two.phi({{}, b, x.t}));
    CHECK(phi[1] == three.phi({b, a, x.t}));
    CHECK(nu[0] == 0);
    CHECK(nu[1] == f.fdot(x.t));
    CHECK(gamma[0] == two.gamma({{}, b, x.t}));
    CHECK(gamma[1] == three.gamma({b, a, x.t}));
    REQUIRE(C.start == std::vector<int>{0, 1, 3});
    CHECK(C.entry[0].body == 1);
    CHECK(C.entry[0].pi == two.variation({{}, b, x.t}).pi_j);
    CHECK(C.entry[1].body == 1);
    CHECK(C.entry[1].r == -c);
    CHECK(C.entry[2].body == 0);
    CHECK(C.entry[2].pi == three.variation({b, a, x.t}).pi_j);

    // residuals include the removed row and are divided by the length of its first variation
    const Model::Residual largest = model.largest_residual(x);
    double expected = 0;
    for (const Model::Row& row : model.all_rows())
        expected = std::max(expected, std::abs(model.scaled_residual(row, x)));
    CHECK(largest.value == expected);
    const Variation v = model.all_rows()[0].block->variation({a, b, x.t});
    CHECK(model.scaled_residual(model.all_rows()[0], x) ==
          Approx(model.all_rows()[0].block->phi({a, b, x.t}) / std::hypot(v.pi_i.norm(), v.pi_j.norm())));
}

TEST_CASE("the pattern of a model includes the complements of its drivers", "[dae][model]")
{
    // The vector a_i along x has derivatives by rotations about y and z, its perpendicular also about x.
    Model model;
    model.add(body("rotor"));
    State x;
    x.body.resize(1);
    x.body[0].A = lie::exp(0.3 * Z);
    model.constrain("driver", DP1(0, X, ground, X, Driver("cos(t + 0.3)")));
    model.prepare(x);
    REQUIRE(model.all_rows()[0].complement);
    const unsigned pattern = model.pattern().entry[0].nonzero;
    CHECK((model.all_rows()[0].block->nonzero() & ~pattern & 0b111111) == 0);
    CHECK((model.all_rows()[0].complement->nonzero() & ~pattern & 0b111111) == 0);
}

TEST_CASE("a pin supports the weight of a pendulum at rest", "[dae][model]")
{
    Model model;
    model.add(body("bar", 3, diagonal(0.1, 1, 1)));
    State x;
    x.body.resize(1);
    x.body[0].r = {0, 0, -2};
    model.constrain("pin", revolute(ground, O, X, 0, {0, 0, 2}, X));
    dae::start(model, x);
    CHECK(x.body[0].rddot.norm() < 1e-15);
    const Reaction hanging = reactions(model, x)[0];
    CHECK((hanging.F - Vec3(0, 0, 3 * 9.81)).norm() < 1e-13);
    CHECK(hanging.T.norm() < 1e-13);

    // Horizontal cantilever: the clamp at its end supports the weight and its moment.
    Model clamped;
    clamped.add(body("bar", 3, diagonal(0.1, 1, 1)));
    State y;
    y.body.resize(1);
    y.body[0].r = {0, 2, 0};
    clamped.constrain("clamp", fixed(ground, 0, y));
    dae::start(clamped, y);
    const Reaction level = reactions(clamped, y)[0];
    CHECK((level.F - Vec3(0, 0, 3 * 9.81)).norm() < 1e-13);
    CHECK(level.T.norm() < 1e-12);  // the point of fixed() is the centre of mass of body j
    CHECK((y.body[0].r.cross(level.F) - Vec3(2 * 3 * 9.81, 0, 0)).norm() < 1e-12);
}

TEST_CASE("a freely falling body follows a parabola and conserves its energy", "[dae][model]")
{
    Model model;
    model.gravity = {1, 0, -9.81};
    model.add(body("stone", 2, diagonal(1, 1, 1)));
    Random random(1);
    State x = random.state(1);
    x.t = 0;
    const Motion at_0 = x.body[0];
    dae::start(model, x);
    CHECK(x.body[0].rddot == model.gravity);
    CHECK(x.body[0].omegadot_bar.norm() < 1e-15);
    const double e = lie::energy(model, x);
    CHECK(e == Approx(0.5 * 2 * at_0.rdot.squaredNorm() + 0.5 * at_0.omega_bar.squaredNorm() -
                      2 * model.gravity.dot(at_0.r)));

    const auto scheme = lie::scheme("rA-half-2").make(model, {});
    const State end = lie::march(x, *scheme, lie::TimeGrid::over(1, 1e-2)).row.back();
    CHECK(end.t == 1);
    CHECK((end.body[0].r - (at_0.r + at_0.rdot + 0.5 * model.gravity)).norm() < 1e-12);
    CHECK((end.body[0].rdot - (at_0.rdot + model.gravity)).norm() < 1e-12);
    // a body with equal principal moments rotates about a fixed axis
    CHECK((end.body[0].A - at_0.A * lie::exp(at_0.omega_bar)).norm() < 1e-12);
    CHECK(lie::energy(model, end) == Approx(e).epsilon(1e-13));
}

TEST_CASE("the energy is the sum of kinetic and potential energy", "[dae][model]")
{
    Model model;
    model.add(body("a", 2, diagonal(1, 2, 2.5)));
    model.add(body("b", 3, diagonal(1, 1, 1)));
    State x;
    x.body.resize(2);
    x.body[0].r = {5, 5, 1};
    x.body[0].rdot = {1, 2, 2};
    x.body[0].omega_bar = {1, 1, 2};
    x.body[1].r = {0, 0, -2};
    // 2*9/2 + (1 + 2 + 10)/2 + 9.81 (2*1 - 3*2)
    CHECK(lie::energy(model, x) == Approx(9 + 6.5 - 4 * 9.81));
}
