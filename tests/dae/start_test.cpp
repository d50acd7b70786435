// SPDX-License-Identifier: GPL-3.0-or-later
/// Consistent initial conditions: shortest projections in the metric of the mass, accelerations and
/// multipliers in closed form, inconsistent data rejected or projected.

#include "dae/start.hpp"

#include "dae/constraints/cd.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/joints.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/projection.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/random_motion.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using Catch::Contains;
using tests::Random;

namespace {

/// A chain of three different bars with a spherical, a universal and a revolute joint: 6 degrees of freedom.
/// The positions satisfy the constraints.
void chain(Model& model, State& x, Random& random)
{
    Vec3 tip = O;
    for (int b = 0; b < 3; ++b) {
        const Mat3 J_bar = Vec3(1 + 0.1 * b, 1.5, 2).asDiagonal();
        model.add({.name = "bar " + std::to_string(b), .m = 1.0 + b, .J_bar = J_bar});
        Motion m;
        m.A = b == 2 ? Mat3(x.body[1].A * lie::exp(0.8 * X)) : random.rotation();
        if (b == 1) {  // its y axis perpendicular to the x axis of bar 0
            const Vec3 y = x.body[0].A.col(0).unitOrthogonal();
            m.A << y.unitOrthogonal(), y, y.unitOrthogonal().cross(y);
        }
        m.r = tip + m.A * Z;
        tip = m.r + m.A * Z;
        x.body.push_back(m);
    }
    model.constrain("ball", spherical(ground, O, 0, -Z));
    model.constrain("cardan", universal(0, Z, X, 1, -Z, Y));
    model.constrain("hinge", revolute(1, Z, X, 2, -Z, X));
}

/// diag(M, J̄) and (Φ_r, Π̄) as dense matrices
Eigen::MatrixXd dense_mass(const Model& model)
{
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(6 * model.bodies(), 6 * model.bodies());
    for (int b = 0; b < model.bodies(); ++b) {
        M.block<3, 3>(6 * b, 6 * b) = model.mass().m[b] * Mat3::Identity();
        M.block<3, 3>(6 * b + 3, 6 * b + 3) = model.mass().J_bar[b];
    }
    return M;
}

Eigen::MatrixXd dense_rows(const Model& model, const State& x)
{
    lie::Rows C = model.pattern();
    model.variation(x, C);
    Eigen::MatrixXd D = Eigen::MatrixXd::Zero(C.rows(), 6 * model.bodies());
    for (int k = 0; k < C.rows(); ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            D.block<1, 6>(k, 6 * C.entry[n].body) << C.entry[n].r.transpose(), C.entry[n].pi.transpose();
    return D;
}

Eigen::VectorXd velocities(const State& x)
{
    Eigen::VectorXd v(6 * x.body.size());
    for (size_t b = 0; b < x.body.size(); ++b) v.segment<6>(6 * b) << x.body[b].rdot, x.body[b].omega_bar;
    return v;
}

/// (δr, δθ) from the pose `from` to the pose of x
Eigen::VectorXd displacement(const State& from, const State& x)
{
    Eigen::VectorXd q(6 * x.body.size());
    for (size_t b = 0; b < x.body.size(); ++b)
        q.segment<6>(6 * b) << x.body[b].r - from.body[b].r,
            lie::log(from.body[b].A.transpose() * x.body[b].A);
    return q;
}

State disturbed(const State& x, double size, Random& random)
{
    State y = x;
    for (Motion& m : y.body) {
        Eigen::Matrix<double, 6, 1> delta;
        delta << random.vector(size), random.vector(size);
        m = tests::displaced(m, delta);
    }
    return y;
}

/// Deviation of a projection q from the shortest one: part of M q tangent to the constraints, divided by |M
/// q|
double tangent_part(const Model& model, const State& x, const Eigen::VectorXd& q)
{
    // motions allowed by the constraints
    const Eigen::MatrixXd N = dense_rows(model, x).fullPivLu().kernel();
    const Eigen::VectorXd Mq = dense_mass(model) * q;
    return (N * N.colPivHouseholderQr().solve(Mq)).norm() / Mq.norm();
}

}  // namespace

TEST_CASE("positions are projected to rounding error by the shortest displacement", "[dae][start]")
{
    Random random(GENERATE(range(1u, 6u)));
    Model model;
    State x;
    chain(model, x, random);
    model.prepare(x);
    REQUIRE(model.largest_residual(x).value < 1e-15);
    lie::Saddle K(model);

    double before = 0;
    for (const double size : {1e-2, 1e-3, 1e-4}) {
        Random same(99);
        const State off = disturbed(x, size, same);
        State on = off;
        CHECK(lie::project_positions(model, K, on) <= 5);
        CHECK(model.largest_residual(on).value < 1e-13);
        for (const Motion& m : on.body) CHECK(lie::orthogonality_error(m.A) < 1e-15);
        // shortest to first order: the tangent part is proportional to the disturbance
        const double tangent = tangent_part(model, on, displacement(off, on));
        INFO("disturbed by " << size << ", tangent part " << tangent << ", before " << before);
        CHECK(tangent < 3 * size);
        if (before > 0) CHECK(tangent < 0.2 * before);
        before = tangent;
    }

    State on = x;
    lie::project_positions(model, K, on);
    CHECK(displacement(x, on).norm() < 1e-14);  // consistent positions do not change
}

TEST_CASE("distant starts are projected, or rejected with the residual", "[dae][start]")
{
    Random random(GENERATE(range(11u, 16u)));
    Model model;
    State x;
    chain(model, x, random);
    model.prepare(x);
    lie::Saddle K(model);
    State on = disturbed(x, 0.7, random);
    lie::project_positions(model, K, on);
    CHECK(model.largest_residual(on).value < 1e-13);

    // No point has the distances 1 m and 5 m from two points that are 2 m apart.
    Model impossible;
    State y;
    impossible.add({.name = "ball", .m = 1, .J_bar = Mat3::Identity()});
    y.body.resize(1);
    y.body[0].r = {0.5, 0.3, 0.1};
    impossible.constrain("near", distance(ground, O, 0, O, 1));
    impossible.constrain("far", distance(ground, 2 * X, 0, O, 5));
    CHECK_THROWS_WITH(dae::start(impossible, y),
                      Contains("constraint 'far'") && Contains("initial positions"));
    CHECK_THROWS_AS(dae::start(impossible, y, {.fix_initial = true}), lie::NumericalFailure);
}

TEST_CASE("velocities are projected as in an ideal impact", "[dae][start]")
{
    Random random(GENERATE(range(21u, 26u)));
    Model model;
    State x;
    chain(model, x, random);
    model.prepare(x);
    for (Motion& m : x.body) m.rdot = random.vector(3), m.omega_bar = random.vector(3);
    lie::Saddle K(model);
    const Eigen::VectorXd before = velocities(x);
    lie::project_velocities(model, K, x);
    const Eigen::VectorXd after = velocities(x);
    CHECK((dense_rows(model, x) * after).cwiseAbs().maxCoeff() < 1e-13);
    CHECK(model.largest_velocity_residual(x).value < 1e-13);

    // Carnot's theorem: the energy loss is the energy of the lost velocities. It holds for the shortest
    // change only.
    const Eigen::MatrixXd M = dense_mass(model);
    const auto energy = [&](const Eigen::VectorXd& v) { return 0.5 * v.dot(M * v); };
    CHECK(energy(before) - energy(after) == Approx(energy(before - after)).epsilon(1e-13));

    lie::project_velocities(model, K, x);
    CHECK((velocities(x) - after).norm() < 1e-14 * after.norm());
}

TEST_CASE("driven velocities are projected onto the driver", "[dae][start]")
{
    Model model;
    State x;
    tests::slider_crank(model, x);
    model.prepare(x);
    lie::Saddle K(model);
    const Eigen::VectorXd exact = velocities(x);
    for (Motion& m : x.body) m.rdot.setZero(), m.omega_bar.setZero();
    lie::project_velocities(model, K, x);  // without degrees of freedom the driver determines all velocities
    CHECK((velocities(x) - exact).norm() < 1e-13);
}

TEST_CASE("a moving pendulum has the accelerations and the reaction of the closed form", "[dae][start]")
{
    // A bar of length 2l on a pin at the origin, in the plane x = 0, at the angle theta to the vertical
    const double theta = GENERATE(-2.5, -0.4, 0.0, 1.0, 3.0), omega = GENERATE(0.0, 2.0, -3.0);
    constexpr double m = 3, l = 0.7, J = 0.5, g = 9.81;
    Model model;
    State x;
    model.add({.name = "bar", .m = m, .J_bar = Vec3(J, 0.4, 0.2).asDiagonal()});
    const Vec3 along(0, std::sin(theta), -std::cos(theta)), ahead(0, std::cos(theta), std::sin(theta));
    Motion bar;
    bar.A = lie::exp(theta * X);
    bar.r = l * along;
    bar.omega_bar = omega * X;
    bar.rdot = l * omega * ahead;
    x.body.push_back(bar);
    // The bar is body i or body j of the joint.
    const bool bar_first = GENERATE(true, false);
    model.constrain(
        "pin", bar_first ? revolute(0, {0, 0, l}, X, ground, O, X) : revolute(ground, O, X, 0, {0, 0, l}, X));
    const StartReport report = dae::start(model, x);
    CHECK(report.rank == 5);
    CHECK(report.degrees_of_freedom == 1);
    CHECK(report.position_residual < 1e-15);

    const double alpha = -m * g * l * std::sin(theta) / (J + m * l * l);
    CHECK(x.body[0].omegadot_bar.x() == Approx(alpha).margin(1e-13));
    CHECK(x.body[0].omegadot_bar.tail<2>().norm() < 1e-13);
    const Vec3 rddot = l * alpha * ahead - l * omega * omega * along;
    CHECK((x.body[0].rddot - rddot).norm() < 1e-12);

    // along the bar: centripetal force and weight; perpendicular to it: inertial force and weight
    const Reaction on_bar = reactions(model, x)[0];
    CHECK(-on_bar.F.dot(along) == Approx(m * l * omega * omega + m * g * std::cos(theta)).margin(1e-12));
    CHECK(on_bar.F.dot(ahead) == Approx(m * (g * std::sin(theta) + l * alpha)).margin(1e-12));
    CHECK(std::abs(on_bar.F.x()) < 1e-13);
    CHECK((on_bar.T - J * alpha * X).norm() < 1e-12);
    // Φ_r = ∓ c: the multipliers of the three CD rows are the components of the reaction with this sign
    CHECK((x.lambda.head<3>() - (bar_first ? 1 : -1) * on_bar.F).norm() < 1e-12);
    CHECK(x.lambda.tail<2>().norm() < 1e-12);
}

TEST_CASE("the saddle system satisfies the Newton-Euler equations and the acceleration constraints",
          "[dae][start]")
{
    Random random(GENERATE(range(31u, 36u)));
    Model model;
    State x;
    chain(model, x, random);
    for (Motion& m : x.body) m.rdot = random.vector(3), m.omega_bar = random.vector(3);
    dae::start(model, x, {.fix_initial = true});
    const std::vector<Reaction> on = reactions(model, x);
    for (int b = 0; b < 3; ++b) {
        const Motion& m = x.body[b];
        const Mat3& J_bar = model.mass().J_bar[b];
        CHECK((model.mass().m[b] * (m.rddot - model.gravity) - on[b].F).norm() < 1e-12);
        CHECK((J_bar * m.omegadot_bar + m.omega_bar.cross(J_bar * m.omega_bar) - on[b].T).norm() < 1e-12);
    }
    Eigen::VectorXd a(18), gamma(model.rows());
    for (int b = 0; b < 3; ++b) a.segment<6>(6 * b) << x.body[b].rddot, x.body[b].omegadot_bar;
    model.gamma(x, gamma);
    CHECK((dense_rows(model, x) * a - gamma).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("the published data of the four-link are rejected with their residual", "[dae][start]")
{
    Model model;
    State x;
    tests::four_link(model, x, tests::FourLinkStart::stored);
    const State given = x;
    try {
        dae::start(model, x);
        FAIL("data off by 8.7e-3 m were accepted");
    } catch (const ConstraintError& e) {
        CHECK_THAT(e.what(), Contains("initial positions") && Contains("constraint 'revD-CD-i'") &&
                                 Contains("--fix-initial"));
        CHECK(model.constraint_name(e.constraint) == "revD-CD-i");
    }
    // The distance of the two points along x
    const Model::Row& row = model.all_rows()[7];
    CHECK(std::abs(row.block->phi({x.body[2], {}, 0})) == Approx(8.7e-3).epsilon(0.01));
    CHECK_THROWS_WITH(dae::start(model, x), Contains("by 0.0087 m, more than 1e-09"));
    CHECK(x.body[2].r == given.body[2].r);  // the data are not changed
    CHECK(x.body[2].A == given.body[2].A);
}

TEST_CASE("the published data of the four-link are projected on request", "[dae][start]")
{
    Model model;
    State x;
    tests::four_link(model, x, tests::FourLinkStart::stored);
    const StartReport report = dae::start(model, x, {.fix_initial = true});
    CHECK(report.projected);
    CHECK(report.rank == 18);
    CHECK(report.dropped.empty());
    CHECK_THAT(report.worst_position, Contains("revD-CD-i"));
    CHECK(report.position_residual > 1e-3);
    // the rotor is at rest, its driver requires pi rad/s
    CHECK(report.velocity_residual == Approx(3.1416).epsilon(0.3));
    CHECK(model.largest_residual(x).value < 1e-12);
    CHECK(model.largest_velocity_residual(x).value < 1e-12);

    // Without degrees of freedom there is one consistent state near the data.
    Model other;
    State y;
    tests::four_link(other, y);
    dae::start(other, y);
    CHECK(displacement(y, x).norm() < 1e-12);
    CHECK((velocities(x) - velocities(y)).norm() < 1e-11);
}

TEST_CASE("a state with another number of bodies than the model is rejected", "[dae][start]")
{
    const int bodies = GENERATE(0, 2, 100);
    Model model;
    model.add({.name = "body", .m = 1, .J_bar = Mat3::Identity()});
    State x;
    x.body.resize(bodies);
    CHECK_THROWS_WITH(start(model, x), Contains("the state must have one motion for each of the 1 bodies"));
}

TEST_CASE("inconsistent velocities are rejected", "[dae][start]")
{
    Model model;
    State x;
    tests::four_link(model, x);
    x.body[0].omega_bar.setZero();
    CHECK_THROWS_WITH(dae::start(model, x), Contains("initial velocities") && Contains("--fix-initial"));
}

TEST_CASE("consistent data are accepted and change by rounding errors only", "[dae][start]")
{
    const auto build = GENERATE(
        +[](Model& m, State& x) { tests::slider_crank(m, x); },
        +[](Model& m, State& x) { tests::four_link(m, x); });
    Model model;
    State x;
    build(model, x);
    const State given = x;
    const StartReport report = dae::start(model, x);
    CHECK(report.rows == 18);
    CHECK(report.rank == 18);
    CHECK(report.degrees_of_freedom == 0);
    CHECK(report.dropped.empty());
    CHECK_FALSE(report.projected);
    CHECK(report.position_residual < 1e-14);
    CHECK(report.velocity_residual < 1e-12);
    CHECK(displacement(given, x).norm() < 1e-13);
    CHECK((velocities(given) - velocities(x)).norm() < 1e-12);
    CHECK(model.largest_residual(x).value < 1e-14);
}

TEST_CASE("a second start of a model gives the same result", "[dae][start]")
{
    Random random(8);
    Model model;
    State x;
    chain(model, x, random);
    model.constrain("ball again", spherical(ground, O, 0, -Z));
    const StartReport first = dae::start(model, x), second = dae::start(model, x);
    CHECK(first.dropped.size() == 3);
    CHECK(second.dropped == first.dropped);
    CHECK(second.rank == first.rank);
}

TEST_CASE("data within the tolerance are projected onto the constraints", "[dae][start]")
{
    Random random(7);
    Model model;
    State x;
    chain(model, x, random);
    State off = disturbed(x, 2e-10, random);
    const StartReport report = dae::start(model, off);
    CHECK(report.position_residual > 1e-11);
    CHECK_FALSE(report.projected);
    CHECK(model.largest_residual(off).value < 1e-14);
}
