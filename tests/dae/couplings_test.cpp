// SPDX-License-Identifier: GPL-3.0-or-later
/// Gear, screw, rack and pinion, point on a curve: variations and γ compared with differences of Φ; counting
/// of revolutions; invalid input. Bushing and limits: forces are derivatives of the potential.

#include "dae/constraints/point_on_curve.hpp"
#include "dae/forces/bushing.hpp"
#include "dae/forces/limits.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>
#include <numbers>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using tests::Random;

namespace {

using Vec12 = Eigen::Matrix<double, 12, 1>;
using std::numbers::pi;
struct Coupling {
    std::string name;
    std::unique_ptr<Constraint> constraint;
};

/// Couplings with random points whose axes are parallel in the initial data x of two bodies
std::vector<Coupling> couplings(const State& x, Random& random)
{
    const Vec3 axis = random.unit(), axis_0 = x.body[0].A.transpose() * axis,
               axis_1 = x.body[1].A.transpose() * axis;
    const Vec3 s = random.vector(), q = random.vector();
    const Vec3 along = axis_0.unitOrthogonal();
    std::vector<Coupling> all;
    all.push_back({"external gear", std::move(gear(0, s, axis_0, 0.3, 1, q, axis_1, 0.5, x)[0])});
    all.push_back({"internal gear", std::move(gear(0, s, axis_0, 0.3, 1, q, -axis_1, -0.7, x)[0])});
    all.push_back({"screw", std::move(screw(0, s, axis_0, 1, q, axis_1, 0.4, x)[4])});
    all.push_back(
        {"rack and pinion", std::move(rack_and_pinion(0, s, along, axis_0, 1, q, axis_1, 0.2, x)[0])});
    return all;
}

/// A point on a helix whose radius varies, at s = 0.7, with the internal states of a start there
struct OnCurve {
    std::array<io::Expression, 3> curve = {io::Expression("(1+0.1*s)*cos(s)", {"s"}),
                                           io::Expression("sin(s)", {"s"}), io::Expression("0.3*s^2", {"s"})};
    Vec3 s_bar;
    Motion bi, bj;
    PointOnCurve constraint;
    double saved[4] = {};

    explicit OnCurve(Random& random)
        : s_bar(random.vector()), bi(random.motion()), bj(random.motion()),
          constraint(0, s_bar, 1, curve, 0.7)
    {
        bi.r =
            bj.r + bj.A * Vec3(curve[0].value(0.7), curve[1].value(0.7), curve[2].value(0.7)) - bi.A * s_bar;
        constraint.update_internal_state({bi, bj}, true, saved);
    }
    Constraint::Arguments at(const Motion& a, const Motion& b) const
    {
        return {.bi = a, .bj = b, .internal_state = saved};
    }
};

/// Compares the first variation and γ of all rows with differences of Φ.
template <class At>
void check_derivatives(const Constraint& c, const Motion& bi, const Motion& bj, At at)
{
    const int rows = c.position_rows();
    Constraint::Derivatives d;
    d.set_zero(c);
    c.variation(at(bi, bj), d);
    double gamma[Constraint::max_rows], Phi[Constraint::max_rows];
    c.gamma(at(bi, bj), gamma);
    Vec12 velocity, acceleration;
    velocity << bi.rdot, bi.omega_bar, bj.rdot, bj.omega_bar;
    acceleration << bi.rddot, bi.omegadot_bar, bj.rddot, bj.omegadot_bar;
    for (int k = 0; k < rows; ++k) {
        Vec12 C;
        C << d.C_i.row(k).transpose(), d.C_j.row(k).transpose();
        for (int n = 0; n < 12; ++n) {
            const auto phi = [&](double s) {
                const Vec12 delta = s * Vec12::Unit(n);
                c.phi(at(tests::displaced(bi, delta.head<6>()), tests::displaced(bj, delta.tail<6>())), Phi);
                return Phi[k];
            };
            INFO("row " << k << ", component " << n);
            CHECK(C[n] == Approx(tests::derivative(phi, 5e-4)).margin(1e-9));
        }
        const auto phi = [&](double tau) {
            c.phi(at(tests::pose_after(bi, tau), tests::pose_after(bj, tau)), Phi);
            return Phi[k];
        };
        CHECK(C.dot(velocity) == Approx(tests::derivative(phi, 2e-4)).margin(1e-8));
        CHECK(C.dot(acceleration) - gamma[k] ==
              Approx(tests::second_derivative(phi, 5e-4)).epsilon(1e-6).margin(1e-5));
    }
}

}  // namespace

TEST_CASE("variations and gamma of couplings of rotations are derivatives of phi", "[dae][constraints]")
{
    Random random(GENERATE(range(1u, 11u)));
    const State x = random.state(2);
    for (const Coupling& c : couplings(x, random)) {
        INFO(c.name);
        // away from the initial data, at a random pose and motion
        const Motion bi = random.motion(), bj = random.motion();
        double saved[2] = {};
        c.constraint->update_internal_state({.bi = bi, .bj = bj, .internal_state = saved}, true, saved);
        check_derivatives(*c.constraint, bi, bj, [&](const Motion& a, const Motion& b) {
            return Constraint::Arguments{.bi = a, .bj = b, .internal_state = saved};
        });
        double Phi = 1;
        c.constraint->phi({x.body[0], x.body[1]}, &Phi);
        CHECK(std::abs(Phi) < 1e-15);
    }
}

TEST_CASE("variations and gamma of a point on a curve are derivatives of phi", "[dae][constraints]")
{
    Random random(GENERATE(range(21u, 31u)));
    const OnCurve c(random);
    check_derivatives(c.constraint, c.bi, c.bj, [&](const Motion& a, const Motion& b) { return c.at(a, b); });
    double Phi[2];
    c.constraint.phi(c.at(c.bi, c.bj), Phi);
    CHECK(std::hypot(Phi[0], Phi[1]) < 1e-14);

    // The default of the second variation agrees with differences of the first.
    const Mat12 H = c.constraint.Constraint::second_variation(c.at(c.bi, c.bj), 1);
    Constraint::Derivatives d;
    d.set_zero(c.constraint);
    for (int n = 0; n < 12; ++n) {
        const auto row = [&](double s) {
            const Vec12 delta = s * Vec12::Unit(n);
            const Motion a = tests::displaced(c.bi, delta.head<6>()),
                         b = tests::displaced(c.bj, delta.tail<6>());
            c.constraint.variation(c.at(a, b), d);
            Vec12 all;
            all << d.C_i.row(1).transpose(), d.C_j.row(1).transpose();
            return all;
        };
        CHECK((H.col(n) - tests::derivative(row, 5e-4)).cwiseAbs().maxCoeff() < 1e-7);
    }
}

TEST_CASE("couplings count revolutions in both directions", "[dae][constraints]")
{
    // Steps of 1 rad over 10 revolutions and back. The wheel rotates by -3/5 of the angle of the pinion.
    State x;
    x.body.resize(2);
    x.body[1].r = 0.8 * X;
    const Blocks pair = gear(0, O, Z, 0.3, 1, O, Z, 0.5, x);
    double saved[2] = {};
    const auto at = [&](double angle, Motion& a, Motion& b) {
        a = x.body[0], b = x.body[1];
        a.A = lie::exp(angle * Z), b.A = lie::exp(-0.6 * angle * Z);
        return Constraint::Arguments{.bi = a, .bj = b, .internal_state = saved};
    };
    Motion a, b;
    for (int n = 0; n <= 126; ++n) {
        const double angle = n <= 63 ? n : 126 - n;
        const Constraint::Arguments arguments = at(angle, a, b);
        CHECK(std::abs(pair[0]->phi(arguments)) < 1e-13);
        pair[0]->update_internal_state(arguments, false, saved);
    }
}

TEST_CASE("a screw advances by its pitch in a turn", "[dae][constraints]")
{
    State x;
    x.body.resize(2);
    const double pitch = 0.04;
    const Blocks rows = screw(0, O, Z, 1, O, Z, pitch, x);
    for (const double angle : {-1., 0.5, 2.}) {
        Motion b = x.body[1];
        b.A = lie::exp(angle * Z), b.r = pitch * angle / (2 * pi) * Z;
        const Constraint::Arguments at{.bi = x.body[0], .bj = b};
        for (const auto& row : rows) CHECK(std::abs(row->phi(at)) < 1e-15);
    }
}

TEST_CASE("a point on a curve follows it over several turns from node to node", "[dae][constraints]")
{
    // A flat helix: the point of the next turn is nearer than half a turn along the curve.
    const double pitch = 0.05;
    const auto coordinate = [](const char* text) { return io::Expression(text, {"s"}); };
    const PointOnCurve constraint(
        0, O, 1, {coordinate("cos(s)"), coordinate("sin(s)"), coordinate("0.05*s/(2*pi)")}, 0);
    Motion bead, wire;
    double saved[4] = {};
    constexpr int steps_of_turn = 40;
    for (int n = 0; n <= 5 * steps_of_turn; ++n) {
        const double s = 2 * pi * n / steps_of_turn;
        bead.r = {std::cos(s), std::sin(s), pitch * n / steps_of_turn};
        const Constraint::Arguments at{.bi = bead, .bj = wire, .internal_state = saved};
        if (n > 0) {
            double Phi[2];
            constraint.phi(at, Phi);
            CHECK(std::hypot(Phi[0], Phi[1]) < 1e-12);
        }
        constraint.update_internal_state(at, n == 0, saved);
        CHECK(saved[0] == Approx(s).margin(1e-12));
    }
}

TEST_CASE("couplings reject axes, radii and positions that do not fit", "[dae][constraints]")
{
    State x;
    x.body.resize(2);
    x.body[1].r = X;
    using Catch::Contains;
    CHECK_THROWS_WITH(gear(0, O, Z, 0.3, 1, O, X, 0.7, x),
                      Contains("gear pair: the two axes must be parallel"));
    CHECK_THROWS_WITH(gear(0, O, Z, 0, 1, O, Z, 0.7, x), Contains("pitch radius") && Contains("got 0"));
    CHECK_THROWS_WITH(gear(0, O, Z, 0.7, 1, O, Z, -0.7, x), Contains("different radii"));
    const Blocks pair = gear(0, O, Z, 0.3, 1, O, Z, 0.6, x);
    CHECK_THAT(pair[0]->start_error({x.body[0], x.body[1]}),
               Contains("must be 0.9 m") && Contains("got 1 m"));
    CHECK(gear(0, O, Z, 0.3, 1, O, Z, 0.7, x)[0]->start_error({x.body[0], x.body[1]}).empty());
    CHECK_THROWS_WITH(screw(0, O, Z, 1, O, -Z, 0.1, x), Contains("screw joint: the two axes"));
    CHECK_THROWS_WITH(rack_and_pinion(0, O, Z, Z, 1, O, Z, 0.1, x),
                      Contains("perpendicular") && Contains("got 1"));
    CHECK_THROWS_WITH(rack_and_pinion(0, O, X, Z, 1, O, X, 0.1, x),
                      Contains("rack and pinion: the two axes"));
}

TEST_CASE("the planar joint leaves two displacements and one rotation", "[dae][joints]")
{
    State x;
    x.body.resize(1);
    const Blocks rows = planar(ground, O, Z, 0, O, Z);
    Motion moved;
    moved.r = Vec3(0.3, -0.4, 0), moved.A = lie::exp(1.2 * Z);
    for (const auto& row : rows) CHECK(std::abs(row->phi({{}, moved})) < 1e-15);
    moved.r.z() = 0.1;
    CHECK(rows[2]->phi({{}, moved}) == Approx(0.1));
    moved.A = lie::exp(0.1 * X);
    CHECK(std::hypot(rows[0]->phi({{}, moved}), rows[1]->phi({{}, moved})) == Approx(std::sin(0.1)));
}

TEST_CASE("forces of a bushing and of limits are derivatives of their potential", "[dae][forces]")
{
    Random random(GENERATE(range(1u, 6u)));
    State x = random.state(2);
    for (Motion& b : x.body) b.rdot.setZero(), b.omega_bar.setZero();
    const State start = x;
    x.body[1].A = x.body[1].A * lie::exp(random.vector(0.8));
    x.body[1].r += random.vector(0.3);

    Bushing::Coefficients c;
    c.stiffness = Vec3(100, 200, 50), c.rotational_stiffness = Vec3(3, 5, 8);
    std::vector<std::unique_ptr<Force>> forces;
    forces.push_back(std::make_unique<Bushing>(0, random.vector(), 1, random.vector(), c, start));
    const Vec3 s = random.vector(), q = random.vector();
    const double l = (x.body[1].r + x.body[1].A * q - x.body[0].r - x.body[0].A * s).norm();
    forces.push_back(
        std::make_unique<DistanceLimit>(0, s, 1, q, Stop{.maximum = 0.7 * l, .stiffness = 40, .damping = 2}));
    forces.push_back(std::make_unique<DistanceLimit>(0, s, 1, q, Stop{.minimum = 1.3 * l, .stiffness = 40}));

    for (const auto& f : forces) {
        lie::Loads loads(2);
        loads.set_zero();
        f->add(x, loads);
        for (int n = 0; n < 12; ++n) {
            const auto potential = [&](double step) {
                State y = x;
                const Eigen::Matrix<double, 6, 1> delta = step * Eigen::Matrix<double, 6, 1>::Unit(n % 6);
                y.body[n / 6] = tests::displaced(y.body[n / 6], delta);
                return f->potential_energy(y);
            };
            const double load = n % 6 < 3 ? loads.F[n / 6][n % 3] : loads.n_bar[n / 6][n % 3];
            CHECK(load == Approx(-tests::derivative(potential, 1e-3)).epsilon(1e-8).margin(1e-8));
        }
        CHECK((loads.F[0] + loads.F[1]).norm() < 1e-12);
    }
}

TEST_CASE("a stop pushes back beyond its range only, and never pulls", "[dae][forces]")
{
    const Stop stop{.minimum = -1, .maximum = 2, .stiffness = 10, .damping = 0.5};
    CHECK(stop.force(0, 100) == 0);
    CHECK(stop.force(2.1, 0) == Approx(1));
    CHECK(stop.force(2.1, 1) == Approx(1.5));
    CHECK(stop.force(2.1, -3) == 0);
    CHECK(stop.force(-1.1, 0) == Approx(-1));
    CHECK(stop.force(-1.1, -1) == Approx(-1.5));
    CHECK(stop.force(-1.1, 3) == 0);
    CHECK(stop.potential(2.1) == Approx(0.05));
    CHECK(stop.potential(0) == 0);
}

TEST_CASE("a distance limit without a direction ends the run with its name", "[dae][forces]")
{
    State x;
    x.body.resize(2);
    lie::Loads loads(2);
    const auto add = [&](const Stop& stop) {
        loads.set_zero();
        DistanceLimit(0, O, 1, O, stop).add(x, loads);
    };
    CHECK_NOTHROW(add(Stop{.maximum = 0.5, .stiffness = 40}));
    CHECK(loads.F[0].norm() == 0);
    CHECK_THROWS_AS(add(Stop{.minimum = 0.1, .stiffness = 40}), lie::NonFinite);
}
