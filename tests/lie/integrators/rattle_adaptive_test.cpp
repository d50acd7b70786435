// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle-adaptive: reversible steps, energy near a centre of attraction, order, failures.

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace hilda;
using lie::State;
using lie::Vec3;

namespace {

/// A top whose centre of mass is attracted by a fixed point near its path: F = k d/|d|³, and from 0.2 s on by
/// `kick` [N] along y
class AttractedTop final : public lie::System {
public:
    explicit AttractedTop(double k, double kick = 0) : k(k), kick(kick) {}

    const lie::Mass& mass() const override { return top.mass(); }
    const lie::Rows& pattern() const override { return top.pattern(); }
    void loads(const State& x, lie::Loads& out) const override
    {
        top.loads(x, out);
        const Vec3 d = centre() - x.body[0].r;
        out.F[0] += k / std::pow(d.norm(), 3) * d;
        if (x.t > 0.2) out.F[0].y() += kick;
        if (noise > 0) out.F[0].y() += noise * double(++evaluations % 7 - 3);
    }
    void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.phi(x, out); }
    void variation(const State& x, lie::Rows& out) const override { top.variation(x, out); }
    void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.nu(x, out); }
    void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.gamma(x, out); }

    /// 2 % beyond the lowest place of the centre of mass
    Vec3 centre() const { return {0, 0, -1.02 * top.s_bar.norm()}; }
    /// Without spin: the centre of mass swings through its lowest place.
    State start() const
    {
        State x = tests::tilted_top(*this, top.s_bar);
        x.body[0].rdot.setZero(), x.body[0].omega_bar.setZero();
        lie::scheme("rA-rattle").make(*this, {})->step(x, 1e-9);
        x.t = 0;
        return x;
    }
    double energy(const State& x) const
    {
        const lie::Motion& body = x.body[0];
        lie::Loads gravity(1);
        top.loads(x, gravity);
        return 0.5 * mass().m[0] * body.rdot.squaredNorm() +
               0.5 * body.omega_bar.dot(mass().J_bar[0] * body.omega_bar) - gravity.F[0].dot(body.r) -
               k / (centre() - body.r).norm();
    }
    const tests::SpinningTop top;
    double noise = 0;  ///< [N], another value in each evaluation

private:
    mutable long evaluations = 0;
    const double k, kick;
};

const lie::Settings tolerance(double rtol) { return {.tolerance = 1e-13, .rtol = rtol}; }

/// The error of the energy that nine tenths of the rows of a part of a run do not exceed, relative to the
/// energy at the start. The largest one depends on how near the attractor a row is.
double error_of_most(const AttractedTop& system, const std::vector<State>& rows, std::size_t from,
                     std::size_t to)
{
    const double E = system.energy(rows[0]);
    std::vector<double> error;
    for (std::size_t k = from; k < to; ++k) error.push_back(std::abs(system.energy(rows[k]) - E));
    std::sort(error.begin(), error.end());
    return error[error.size() * 9 / 10] / std::abs(E);
}

}  // namespace

TEST_CASE("reversible steps need fewer steps near a centre of attraction, and the energy does not drift",
          "[lie][rattle][adaptive]")
{
    const AttractedTop system(0.02);
    const auto run = [&](const lie::Scheme& s, const lie::Settings& settings, double h, long& steps) {
        const auto integrator = s.make(system, settings);
        auto rows = lie::march(system.start(), *integrator, lie::TimeGrid::over(60, h)).row;
        steps = integrator->statistics().steps;
        return rows;
    };
    long steps = 0, fixed_steps = 0;
    const auto rows = run(lie::scheme("rA-rattle-adaptive"), tolerance(1e-7), 0.01, steps);
    const auto fixed = run(lie::scheme("rA-rattle"), {.tolerance = 1e-13}, 60. / double(steps), fixed_steps);
    const double early = error_of_most(system, rows, 0, rows.size() / 4),
                 late = error_of_most(system, rows, rows.size() * 3 / 4, rows.size()),
                 of_fixed = error_of_most(system, fixed, 0, fixed.size());
    INFO(steps << " steps: " << early << ", " << late << "; fixed " << of_fixed);
    CHECK(fixed_steps == Approx(steps).margin(2));
    CHECK(late < 2 * early);  // measured for ten values of k: 0.6 to 1.3; a linear drift has 7
    CHECK(early < of_fixed / 5);
}

TEST_CASE("reversible steps return to the start", "[lie][rattle][adaptive]")
{
    const AttractedTop system(0.02);
    const auto integrator = lie::scheme("rA-rattle-adaptive").make(system, tolerance(1e-6));
    const State start = system.start();
    State x = start;
    integrator->step(x, 1.3);
    // State::history: begin and end of the last step, ε, ρ, F_0², F_0² + F² at the start, the states at the
    // ends of the step
    constexpr Eigen::Index times = 6, rdot = 3, omega_bar = 18;  // places of a motion
    const Eigen::Index length = (x.history.size() - times) / 2;
    const double elapsed = x.history[0];
    REQUIRE(elapsed > 1);
    // From the begin of the last step with the opposite velocities: ρ of that step minus ε G there is the ρ
    // of the step before.
    x.history.segment(times + length, length) = x.history.segment(times, length);
    for (const Eigen::Index velocity : {rdot, omega_bar})
        x.history.segment<3>(times + length + velocity) *= -1;
    x.history[0] = x.history[1] = x.t = 0;
    integrator->step(x, elapsed);
    const lie::Motion &now = x.body[0], &then = start.body[0];
    CHECK((now.r - then.r).norm() < 1e-10);
    CHECK((now.A - then.A).norm() < 1e-10);
    CHECK((now.rdot + then.rdot).norm() < 1e-10);
}

TEST_CASE("the error of reversible steps is of order 2 in the first step", "[lie][rattle][adaptive][order]")
{
    const AttractedTop system(0.02);
    const auto end = [&](const lie::Scheme& s, double rtol, double& epsilon) {
        State x = system.start();
        s.make(system, tolerance(rtol))->step(x, 0.9);
        epsilon = x.history[2];
        return x;
    };
    double epsilon[2], ignored = 0;
    const State exact = end(lie::scheme("rA-dop853").with_adaptive_steps(), 1e-13, ignored),
                coarse = end(lie::scheme("rA-rattle-adaptive"), 1e-8, epsilon[0]),
                fine = end(lie::scheme("rA-rattle-adaptive"), 1e-10, epsilon[1]);
    const auto error = [&](const State& x) {
        return (x.body[0].r - exact.body[0].r).norm() + (x.body[0].rdot - exact.body[0].rdot).norm();
    };
    const double order = std::log(error(coarse) / error(fine)) / std::log(epsilon[0] / epsilon[1]);
    INFO(error(coarse) << ", " << error(fine));
    CHECK(order == Approx(2).margin(0.1));
    CHECK(epsilon[0] / epsilon[1] == Approx(std::cbrt(100.)).epsilon(0.1));
}

TEST_CASE("reversible steps do not depend on the output instants, and continue with the same digits",
          "[lie][rattle][adaptive][resume]")
{
    const AttractedTop system(0.02);
    const State start = system.start();
    const auto make = [&] { return lie::scheme("rA-rattle-adaptive").make(system, tolerance(1e-6)); };
    const auto seldom = make(), often = make();
    State x = start, y = start;
    seldom->step(x, 1);
    std::vector<State> nodes;
    for (int n = 0; n < 256; ++n) often->step(y, 1. / 256), nodes.push_back(y);
    CHECK(seldom->statistics().steps == often->statistics().steps);
    CHECK(x.body[0].r == y.body[0].r);
    CHECK(x.history == y.history);
    for (const std::size_t n : {0, 17, 130, 250}) {
        State z = nodes[n];
        const auto resumed = make();
        for (std::size_t k = n + 1; k < nodes.size(); ++k) resumed->step(z, 1. / 256);
        INFO("from node " << n);
        CHECK(z.body[0].r == y.body[0].r);
        CHECK(z.lambda == y.lambda);
        CHECK(z.history == y.history);
    }
}

namespace {

/// A free body on a spring to the origin, F = -k r
class Oscillator final : public lie::System {
public:
    explicit Oscillator(double k) : k(k) {}
    const lie::Mass& mass() const override { return body.mass(); }
    const lie::Rows& pattern() const override { return body.pattern(); }
    void loads(const State& x, lie::Loads& out) const override
    {
        out.F[0] = -k * x.body[0].r, out.n_bar[0].setZero();
    }
    void phi(const State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const State&, lie::Rows&) const override {}
    void nu(const State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const State&, Eigen::Ref<Eigen::VectorXd>) const override {}

    const tests::SpinningTop body{true};

private:
    const double k;
};

}  // namespace

TEST_CASE("reversible steps of a run that starts without loads", "[lie][rattle][adaptive]")
{
    for (const double k : {200., 0.}) {
        const Oscillator system(k);
        State x = system.body.start();
        x.body[0].r = Vec3(0, 0, 1e-17), x.body[0].rdot = Vec3(1, 0, 0), x.body[0].rddot.setZero();
        x.body[0].omega_bar.setZero(), x.body[0].omegadot_bar.setZero();
        const auto integrator = lie::scheme("rA-rattle-adaptive").make(system, tolerance(1e-7));
        integrator->step(x, 7);
        const double rate = std::sqrt(k / 2), exact = k > 0 ? std::sin(7 * rate) / rate : 7;
        INFO("k = " << k << ", " << integrator->statistics().steps << " steps");
        CHECK(x.body[0].r.x() == Approx(exact).margin(2e-3));
        CHECK(integrator->statistics().steps < 20000);
    }
}

TEST_CASE("a tolerance below rounding and a distance that is not positive are refused",
          "[lie][rattle][adaptive]")
{
    AttractedTop system(0.02);
    State x = system.start();
    system.noise = 1e6;
    CHECK_THROWS_WITH(lie::scheme("rA-rattle-adaptive").make(system, tolerance(1e-14))->step(x, 1),
                      Catch::StartsWith("rA-rattle-adaptive at t = 0 s: the local error of no step is below "
                                        "the tolerance (rtol 1e-14"));
    system.noise = 0;
    CHECK(x.history.size() == 0);
    for (const double h : {0., -1.})
        CHECK_THROWS_WITH(lie::scheme("rA-rattle-adaptive").make(system, tolerance(1e-6))->step(x, h),
                          Catch::Contains("the distance of two nodes must be positive"));
}

TEST_CASE("reversible steps end where they cannot follow the loads, and with constant loads they are equal",
          "[lie][rattle][adaptive]")
{
    const AttractedTop kicked(0.02, 1e4);
    State x = kicked.start();
    const State before = x;
    try {
        lie::scheme("rA-rattle-adaptive").make(kicked, tolerance(1e-6))->step(x, 10);
        CHECK(false);
    } catch (const lie::NumericalFailure& failure) {
        INFO(failure.what());
        CHECK_THAT(failure.what(), Catch::StartsWith("rA-rattle-adaptive at t = "));
        CHECK_THAT(failure.what(), Catch::Contains("use a smaller rtol"));
    }
    CHECK(x.body[0].r == before.body[0].r);
    CHECK(x.history.size() == 0);

    const tests::SpinningTop top;
    const auto integrator = lie::scheme("rA-rattle-adaptive").make(top, tolerance(1e-6));
    State y = top.start();
    integrator->step(y, 1);
    CHECK(y.history[3] == 1);  // ρ
    const double length = y.history[1] - y.history[0];
    CHECK(length == Approx(y.history[2]).epsilon(1e-12));
}
