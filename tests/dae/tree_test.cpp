// SPDX-License-Identifier: GPL-3.0-or-later
/// Trees of joints: what is recognised, accelerations and motions against those of the constraint equations.

#include "dae/tree.hpp"
#include "dae/constraints/cd.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/system.hpp"
#include "lie/trajectory.hpp"
#include "lie/tree/articulated_bodies.hpp"
#include "lie/tree/joint_coordinates.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/motion_difference.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using Kind = lie::TreeJoint::Kind;

namespace {

int add_body(Model& model, State& x, const Vec3& r)
{
    const int b = model.add({.name = "b" + std::to_string(x.body.size()), .m = 1, .J_bar = Mat3::Identity()});
    x.body.emplace_back().r = r;
    return b;
}

State at_end(const Model& model, const State& x, const std::string& scheme, double h, double t_end)
{
    const auto integrator = lie::scheme(scheme).make(model, {.tolerance = 1e-13, .rtol = 1e-13});
    return lie::march(x, *integrator, lie::TimeGrid::over(t_end, h, t_end)).row.back();
}

/// Bodies with a joint to the ground or to a body before them, by turns revolute, spherical, translational
/// and fixed; every seventh body is free. Body numbers and the order of i and j do not follow the tree.
/// Springs with dampers connect bodies that have no joint. `x` is a consistent start in motion.
void random_tree(int bodies, unsigned seed, Model& model, State& x)
{
    tests::Random random(seed);
    for (int b = 0; b < bodies; ++b) {
        const Mat3 R = random.rotation();
        const Vec3 sides = random.vector().cwiseAbs() + Vec3::Constant(0.3);
        const Vec3 squares = sides.cwiseProduct(sides);
        const double m = random.number(0.5, 1.5);
        const Vec3 J(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y());
        model.add({.name = "body " + std::to_string(b),
                   .m = m,
                   .J_bar = R * (m / 12 * J).asDiagonal() * R.transpose()});
        Motion& body = x.body.emplace_back();
        body.r = random.vector(2), body.A = random.rotation();
        body.rdot = random.vector(), body.omega_bar = random.vector();
    }
    // Body n of the tree is body (5 n + 2) mod N of the model; 5 must not divide N.
    const auto of_tree = [&](int n) { return n < 0 ? ground : (5 * n + 2) % bodies; };
    for (int n = 0; n < bodies; ++n) {
        if (n % 7 == 6) continue;
        int i = of_tree(n < 2 ? -1 : static_cast<int>(random.number(0, n))), j = of_tree(n);
        if (n % 3 == 1) std::swap(i, j);
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        const Vec3 p = random.vector(), a = random.unit();
        const Vec3 q = n % 4 == 2 ? Vec3(p + random.number() * a) : p;
        const Vec3 s_i = bi.A.transpose() * (p - bi.r), s_j = bj.A.transpose() * (q - bj.r);
        const Vec3 a_i = bi.A.transpose() * a, a_j = (n % 8 == 0 ? 1 : -1) * bj.A.transpose() * a;
        const std::string name = "joint " + std::to_string(n);
        if (n % 4 == 0) model.constrain(name, revolute(i, s_i, a_i, j, s_j, a_j));
        if (n % 4 == 1) model.constrain(name, spherical(i, s_i, j, s_j));
        if (n % 4 == 2) model.constrain(name, translational(i, s_i, a_i, j, s_j, a_j, x));
        if (n % 4 == 3) model.constrain(name, fixed(i, j, x));
    }
    for (int b = 0; b + 3 < bodies; b += 2)
        model.load(SpringDamper(b, random.vector(0.1), b + 3, random.vector(0.1), 20, 1, 0.3));
    start(model, x, {.fix_initial = true});
}

}  // namespace

TEST_CASE("the joints of a tree are recognised, whatever the order of its bodies", "[dae][tree]")
{
    Model model;
    State x;
    random_tree(14, 1, model, x);
    const lie::Tree& tree = model.tree();
    REQUIRE(tree.refusal.empty());
    REQUIRE(tree.joint.size() == 14);
    int of_kind[5] = {};
    std::vector<bool> reached(14, false);
    for (const lie::TreeJoint& joint : tree.joint) {
        ++of_kind[static_cast<int>(joint.kind)];
        CHECK((joint.before == ground || reached[joint.before]));
        reached[joint.body] = true;
    }
    // Joints 0 to 13, by turns; 6 and 13 are missing.
    CHECK(of_kind[static_cast<int>(Kind::hinge)] == 4);
    CHECK(of_kind[static_cast<int>(Kind::ball)] == 3);
    CHECK(of_kind[static_cast<int>(Kind::slide)] == 2);
    CHECK(of_kind[static_cast<int>(Kind::fixed)] == 3);
    CHECK(of_kind[static_cast<int>(Kind::free)] == 2);
}

TEST_CASE("rows that are given one by one are a joint", "[dae][tree]")
{
    Model model;
    State x;
    const int b = add_body(model, x, Vec3(1, 2, 3));
    // Q of the body is at (1, 2, 4); the rows give the components of a point of the ground separately.
    const Vec3 Q(0, 0, 1);
    for (int k = 0; k < 3; ++k)
        model.constrain("row " + std::to_string(k),
                        CD(Vec3::Unit(k), ground, Vec3::Zero(), b, Q, Driver(Vec3(1, 2, 4)[k])));
    start(model, x);
    REQUIRE(model.tree().refusal.empty());
    REQUIRE(model.tree().joint.size() == 1);
    CHECK(model.tree().joint[0].kind == Kind::ball);
    CHECK(model.tree().joint[0].s_bar_i == Vec3(1, 2, 4));
    CHECK(model.tree().joint[0].s_bar_j == Q);
}

TEST_CASE("what is not a tree is refused with the reason", "[dae][tree]")
{
    const auto refusal = [](const auto& build) {
        Model model;
        State x;
        build(model, x);
        start(model, x, {.fix_initial = true});
        const lie::Scheme& scheme = lie::scheme("tree-rk-4");
        CHECK_FALSE(scheme.takes(model));
        CHECK_THROWS_WITH(scheme.make(model, {}), Catch::Contains(model.tree().refusal) &&
                                                      Catch::Contains("integrates trees of joints only"));
        return model.tree().refusal;
    };
    const Vec3 O = Vec3::Zero(), X = Vec3::UnitX(), Y = Vec3::UnitY();
    CHECK(refusal([&](Model& model, State& x) {
              const int a = add_body(model, x, O), b = add_body(model, x, X);
              model.constrain("first", spherical(ground, O, a, O));
              model.constrain("second", spherical(a, X, b, O));
              model.constrain("third", revolute(b, X, Y, ground, 2 * X, Y));
          }) == "constraint 'third' row 1; bodies 'b1', 'ground' is redundant, and not a row of a tree");
    CHECK(refusal([&](Model& model, State& x) {
              const int a = add_body(model, x, O), b = add_body(model, x, Y);
              model.constrain("first", spherical(ground, X, a, X));
              model.constrain("second", spherical(a, -X, b, Vec3(-1, -1, 0)));
              model.constrain("third", spherical(b, Y, ground, 2 * Y));
          }) == "constraint 'second' row 1; bodies 'b0', 'b1' closes a loop");
    CHECK(refusal([&](Model& model, State& x) {
              model.constrain("cross", universal(ground, O, X, add_body(model, x, O), O, Y));
          }).find("constraint 'cross' row 1; bodies 'ground', 'b0' and the other rows") == 0);
    CHECK(refusal([&](Model& model, State& x) {
              model.constrain("drive", CD(X, ground, O, add_body(model, x, O), O, Driver("sin(t)")));
          }) ==
          "constraint 'drive' row 1; bodies 'ground', 'b0' is not a row of a revolute, translational, "
          "spherical or "
          "fixed "
          "joint");
    CHECK(refusal([&](Model& model, State& x) { tests::slider_crank(model, x); }) != "");
}

TEST_CASE("the accelerations of trees are those of the constraint equations", "[dae][tree]")
{
    for (const int number : {1, 2, 3, 4, 6, 7, 8, 9, 11, 12, 13, 14, 16, 17, 18, 19, 21, 36}) {
        Model model;
        State x;
        random_tree(number, static_cast<unsigned>(number), model, x);
        CAPTURE(number);
        REQUIRE(model.tree().refusal.empty());
        lie::Loads loads(model.bodies());
        lie::JointCoordinates coordinates(model.tree());
        lie::ArticulatedBodies bodies(model.mass(), model.tree());
        Eigen::VectorXd w(coordinates.freedoms()), wdot(w), qddot(w);
        coordinates.start(x, w, wdot);
        State y = x;
        for (lie::Motion& body : y.body) body.rddot.setZero(), body.omegadot_bar.setZero();
        model.loads(y, loads);
        bodies.solve(y, loads, qddot);
        double size = 1, error = 0;
        for (size_t b = 0; b < x.body.size(); ++b) {
            size = std::max({size, x.body[b].rddot.norm(), x.body[b].omegadot_bar.norm()});
            error = std::max({error, (x.body[b].rddot - y.body[b].rddot).norm(),
                              (x.body[b].omegadot_bar - y.body[b].omegadot_bar).norm()});
        }
        CHECK(error < 1e-11 * size);
        CHECK((qddot - wdot).norm() < 1e-11 * size);
        // The poses at the origin, and velocities from the rates in two ways
        coordinates.place(Eigen::VectorXd::Zero(w.size()), w, y);
        CHECK(tests::motion_difference(x, y) < 1e-12);
        Eigen::VectorXd v = Eigen::VectorXd::Zero(12 * model.bodies());
        coordinates.spread(w, 0, v);
        for (int b = 0; b < model.bodies(); ++b) {
            CHECK((v.segment<3>(12 * b) - x.body[b].rdot).norm() < 1e-12);
            CHECK((v.segment<3>(12 * b + 3) - x.body[b].omega_bar).norm() < 1e-12);
        }
    }
}

TEST_CASE("schemes on a tree have their orders and keep the joints", "[dae][tree][order]")
{
    Model model;
    State x;
    random_tree(9, 3, model, x);
    REQUIRE(model.tree().refusal.empty());
    const double end = 0.2;
    const State exact = at_end(model, x, "rA-dop853", 1e-3, end);
    const auto error = [&](const std::string& scheme, double h) {
        const State y = at_end(model, x, scheme, h, end);
        CHECK(model.largest_residual(y).value < 1e-13);
        CHECK(model.largest_velocity_residual(y).value < 1e-12);
        return tests::motion_difference(y, exact);
    };
    const auto order = [&](const std::string& scheme, double h, double ratio = 2) {
        return std::log(error(scheme, h) / error(scheme, h / ratio)) / std::log(ratio);
    };
    CHECK(order("tree-euler-1", 1e-4) == Approx(1).margin(0.05));
    CHECK(order("tree-rk-4", 4e-3) == Approx(4).margin(0.15));
    // The next terms of the error are not small where it is above rounding; the spinning top has both sides.
    CHECK(order("tree-dp-5", 8e-3, 4) == Approx(5).margin(0.5));
    CHECK(order("tree-dop853", 4e-2) == Approx(8).margin(0.6));
}

TEST_CASE("multipliers of a tree are those of the constraint equations", "[dae][tree]")
{
    Model model;
    State x;
    random_tree(9, 3, model, x);
    State y = x;
    const auto every = lie::scheme("tree-rk-4").make(model, {}),
               asked = lie::scheme("tree-rk-4").make(model, {.multipliers = false});
    for (int n = 0; n < 10; ++n) every->step(x, 1e-3), asked->step(y, 1e-3);
    CHECK(tests::motion_difference(x, y) == 0);
    CHECK(x.lambda != y.lambda);
    asked->set_multipliers(y);
    CHECK(x.lambda == y.lambda);
    lie::Saddle K(model);
    lie::solve_accelerations(model, K, y);
    CHECK((x.lambda - y.lambda).norm() < 1e-9 * y.lambda.norm());
}

TEST_CASE("adaptive steps on a tree meet their tolerance, and do not depend on the output",
          "[dae][tree][adaptive]")
{
    Model model;
    State x;
    random_tree(9, 3, model, x);
    const State exact = at_end(model, x, "rA-dop853", 1e-3, 1);
    for (const std::string name : {"tree-dp-5", "tree-dop853"}) {
        const lie::Scheme& scheme = lie::scheme(name).with_adaptive_steps();
        double before = 1;
        for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-10}) {
            const auto one = scheme.make(model, {.rtol = rtol}), ten = scheme.make(model, {.rtol = rtol});
            const State a = lie::march(x, *one, lie::TimeGrid::over(1, 1)).row.back(),
                        b = lie::march(x, *ten, lie::TimeGrid::over(1, 0.1)).row.back();
            const double error = tests::motion_difference(a, exact);
            CAPTURE(name, rtol, error, one->statistics().steps);
            CHECK(one->statistics().steps == ten->statistics().steps);
            CHECK(tests::motion_difference(a, b) < 1e-13);
            CHECK(error < 300 * rtol);
            CHECK(error > 0.01 * rtol);
            CHECK(error < before);
            before = error;
        }
    }
}

TEST_CASE("a step on a tree allocates no memory", "[dae][tree][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("skipped: a sanitizer replaces the allocator");
        return;
    }
    Model model;
    State x;
    random_tree(9, 3, model, x);
    for (const char* name : {"tree-euler-1", "tree-rk-4", "tree-dp-5", "tree-dop853"})
        for (const lie::Scheme* scheme : {&lie::scheme(name), &lie::scheme(name).with_adaptive_steps()}) {
            const auto integrator = scheme->make(model, {.rtol = 1e-6});
            State y = x;
            for (int n = 0; n < 3; ++n) integrator->step(y, 1e-2);
            CHECK(tests::allocations_during([&] {
                      for (int n = 0; n < 50; ++n) integrator->step(y, 1e-2);
                  }) == 0);
        }
}
