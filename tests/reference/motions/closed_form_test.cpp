// SPDX-License-Identifier: GPL-3.0-or-later
/// Planar chains and tops: reference trajectories, closed forms, invariants and derivatives.

#include "reference/motions/closed_form.hpp"

#include "tests/reference/chains.hpp"
#include "tests/reference/reference_csv.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <gsl/gsl_sf_ellint.h>

#include <array>
#include <numbers>

using namespace hilda;
using namespace hilda::reference;

namespace {

using std::numbers::pi;

/// Resultant constraint loads of the motion x under gravity, by the Newton-Euler equations
std::vector<dae::Reaction> newton_euler(const tests::DoublePendulum& p, const Vec3& gravity,
                                        const lie::State& x)
{
    std::vector<dae::Reaction> all;
    for (size_t b = 0; b < 2; ++b) {
        const double length = b == 0 ? 4 : 2;
        const Motion& body = x.body[b];
        const Mat3 J_bar = p.J_bar(length).asDiagonal();
        all.push_back({p.mass(length) * (body.rddot - gravity),
                       J_bar * body.omegadot_bar + body.omega_bar.cross(J_bar * body.omega_bar)});
    }
    return all;
}

/// Checks that ṙ, r̈, ω̄, ω̄̇ are the derivatives of r, ṙ, A, ω̄. `rate` [1/s] is the rate of change of the
/// motion. With h · rate = 4e-3 the truncation error is 1e-11 (h⁴ f⁽⁵⁾/30) and the rounding error is smaller.
struct FiveMotions {
    double h;
    std::array<Motion, 5> motion;  ///< at t - 2h, t - h, t, t + h, t + 2h

    template <class Member>
    auto derivative(Member member) const
    {
        return tests::derivative([&](double s) { return motion[2 + std::lround(s / h)].*member; }, h);
    }
    void check(double rate) const
    {
        const Motion& m = motion[2];
        const Mat3 Adot = derivative(&Motion::A);
        CHECK((derivative(&Motion::r) - m.rdot).norm() < 1e-8 * (1 + m.rdot.norm()));
        CHECK((derivative(&Motion::rdot) - m.rddot).norm() < 1e-8 * (1 + m.rddot.norm()));
        CHECK((m.A.transpose() * Adot - lie::tilde(m.omega_bar)).norm() < 1e-8 * rate);
        CHECK((derivative(&Motion::omega_bar) - m.omegadot_bar).norm() < 1e-8 * rate * rate);
        CHECK(lie::orthogonality_error(m.A) < 1e-14);
    }
};

template <class At>
void check_derivatives(const At& at, double t)
{
    const Motion m = at(t);
    const double rate = std::max({1.0, m.omega_bar.norm(), std::sqrt(m.omegadot_bar.norm())}),
                 h = 4e-3 / rate;
    FiveMotions{h, {at(t - 2 * h), at(t - h), m, at(t + h), at(t + 2 * h)}}.check(rate);
}

}  // namespace

TEST_CASE("the equations in two angles reproduce the reference trajectories",
          "[reference][closed_form][acceptance]")
{
    struct Example {
        const char* file;
        tests::DoublePendulum pendulum;
    };
    for (const Example& c :
         {Example{"double_pendulum.csv", {}}, Example{"double_pendulum_w005.csv", {.w = 0.05}},
          Example{"x_double_pendulum_moving.csv", {.w = 0.1, .thetadot_1 = 1, .thetadot_2 = -2}}}) {
        const PlanarChain chain = c.pendulum.angles();
        const auto reference = tests::references(c.file);
        REQUIRE(reference.size() == 31);
        const lie::Trajectory run = chain.at(tests::instants(reference));
        std::vector<std::vector<dae::Reaction>> loads;
        for (const lie::State& x : run.row) loads.push_back(newton_euler(c.pendulum, chain.gravity, x));
        const tests::Deviation d = tests::deviation(run.row, reference);
        const double Q = tests::reaction_deviation(loads, reference);
        UNSCOPED_INFO(c.file << ": " << d << ", loads " << Q);
        CHECK(d.r < 1e-11);
        CHECK(d.A < 1e-11);
        CHECK(d.rdot < 1e-11);
        CHECK(d.omega_bar < 1e-11);
        CHECK(d.rddot < 1e-10);
        CHECK(d.omegadot_bar < 1e-10);
        CHECK(Q < 1e-11);
    }
}

TEST_CASE("the period of a single bar is the elliptic integral", "[reference][closed_form]")
{
    const double m = 3, J = 0.7, a = 0.45, theta = 2.5;
    const PlanarChain chain{.bar = {{.length = 2 * a, .m = m, .J = J, .theta = theta, .thetadot = 0}}};
    const double quarter = std::sqrt((J + m * a * a) / (m * 9.81 * a)) *
                           gsl_sf_ellint_Kcomp(std::sin(theta / 2), GSL_PREC_DOUBLE);
    const lie::Trajectory run = chain.at({quarter, 2 * quarter, 4 * quarter});
    const auto angle = [](const lie::State& x) { return std::atan2(x.body[0].r.y(), -x.body[0].r.z()); };
    CHECK(angle(run.row[0]) == Approx(0).margin(1e-12));
    CHECK(angle(run.row[1]) == Approx(-theta).margin(1e-12));
    CHECK(angle(run.row[2]) == Approx(theta).margin(1e-12));
    CHECK(run.row[2].body[0].omega_bar.norm() < 1e-11);
}

TEST_CASE("a chain of four bars in an inclined plane conserves energy and has consistent derivatives",
          "[reference][closed_form]")
{
    const Vec3 e = Vec3(1, 2, -2) / 3, axis = Vec3(2, 1, 2) / 3;
    const PlanarChain chain{
        .bar = {{1.0, 2, 0.3, 0.4, 1}, {0.7, 1, 0.2, -1, 2}, {0.8, 3, 0.3, 2, 0}, {0.9, 1, 0.2, 0, -1}},
        .origin = Vec3(1, -1, 2),
        .e = e,
        .axis = axis,
        .gravity = Vec3(-3, 1, 6),
        .t_0 = 0.5};
    const auto energy = [&](const lie::State& x) {
        double sum = 0;
        for (size_t b = 0; b < 4; ++b) {
            const Motion& body = x.body[b];
            sum += 0.5 * chain.bar[b].m * body.rdot.squaredNorm() +
                   0.5 * chain.bar[b].J * body.omega_bar.squaredNorm() -
                   chain.bar[b].m * chain.gravity.dot(body.r);
        }
        return sum;
    };
    const double rate = 20, h = 4e-3 / rate, t = 0.7;
    const lie::Trajectory run = chain.at({0.5, t - 2 * h, t - h, t, t + h, t + 2 * h});
    for (const lie::State& x : run.row) CHECK(energy(x) == Approx(energy(run.row[0])).epsilon(1e-12));
    for (size_t b = 0; b < 4; ++b) {
        FiveMotions five{.h = h, .motion = {}};
        for (size_t k = 0; k < 5; ++k) five.motion[k] = run.row[k + 1].body[b];
        five.check(rate);
    }
}

TEST_CASE("the rates of a regular precession are the derivatives of its attitude", "[reference][closed_form]")
{
    tests::Random random(GENERATE(1u, 2u));
    const Mat3 A_0 = random.rotation();
    const RegularPrecession precession{.a = random.vector(3), .b_bar = random.vector(3)};
    check_derivatives([&](double t) { return precession.attitude(A_0, t); }, 0.8);
    CHECK((precession.attitude(A_0, 0).A - A_0).norm() < 1e-15);
}

TEST_CASE("a free symmetric top satisfies Euler's equations and conserves momentum and energy",
          "[reference][closed_form]")
{
    tests::Random random(7);
    for (const Vec3& J_bar :
         {Vec3(0.02, 0.02, 0.01), Vec3(0.03, 0.02, 0.02), Vec3(0.02, 0.03, 0.02), Vec3(0.02, 0.02, 0.02)}) {
        Motion start = random.motion();
        start.omega_bar = random.vector(9);
        const Vec3 gravity = random.vector(9);
        const FreeTop top(J_bar, start, gravity, 0.25);
        const Vec3 H = start.A * J_bar.cwiseProduct(start.omega_bar);
        const double energy = start.omega_bar.dot(J_bar.cwiseProduct(start.omega_bar));
        CHECK((top.at(0.25).A - start.A).norm() < 1e-14);
        CHECK((top.at(0.25).omega_bar - start.omega_bar).norm() < 1e-13);
        for (const double t : {0.25, 1.0, 3.0}) {
            const Motion m = top.at(t);
            check_derivatives([&](double s) { return top.at(s); }, t);
            const Vec3 L_bar = J_bar.cwiseProduct(m.omega_bar);
            CHECK((J_bar.cwiseProduct(m.omegadot_bar) + m.omega_bar.cross(L_bar)).norm() <
                  1e-12 * L_bar.norm());
            CHECK((m.A * L_bar - H).norm() < 1e-13 * H.norm());
            CHECK(m.omega_bar.dot(L_bar) == Approx(energy).epsilon(1e-13));
            CHECK((m.rddot - gravity).norm() == 0);
        }
    }
    CHECK_THROWS_WITH(FreeTop(Vec3(1, 2, 2.5), Motion(), Vec3::Zero()),
                      Catch::Contains("two principal moments"));
}

TEST_CASE("the moment of the weight is the rate of the angular momentum of a heavy top",
          "[reference][closed_form]")
{
    for (const double theta : {0.0, 0.6, pi / 2, 2.5}) {
        const HeavyTop top{.m = 2, .J_1 = 0.0206, .J_3 = 0.04, .l = 0.1, .theta = theta, .Omega = 2};
        const auto momentum = [&](double t) {  // about the tip
            const Motion m = top.at(t);
            return Vec3(top.m * m.r.cross(m.rdot) +
                        m.A * Vec3(top.J_1, top.J_1, top.J_3).cwiseProduct(m.omega_bar));
        };
        for (const double t : {0.0, 0.9}) {
            INFO("theta " << theta << ", t " << t);
            check_derivatives([&](double s) { return top.at(s); }, t);
            const Vec3 moment = top.at(t).r.cross(Vec3(0, 0, -top.m * top.g));
            CHECK((tests::derivative([&](double s) { return momentum(t + s); }) - moment).norm() < 1e-9);
            CHECK(std::acos(top.at(t).A(2, 2)) == Approx(theta).margin(1e-7));
        }
        // Rz(Ωt) Rx(θ) Rz(ψ̇t)
        const double psi = (top.omega_bar_3() - top.Omega * std::cos(theta)) * 0.9;
        const Mat3 A = (Eigen::AngleAxisd(top.Omega * 0.9, Vec3::UnitZ()) *
                        Eigen::AngleAxisd(theta, Vec3::UnitX()) * Eigen::AngleAxisd(psi, Vec3::UnitZ()))
                           .toRotationMatrix();
        CHECK((top.at(0.9).A - A).norm() < 1e-13);
    }
}

TEST_CASE("Jacobi's elliptic functions satisfy Euler's equations of an asymmetric top",
          "[reference][closed_form]")
{
    const Vec3 J_bar(0.02, 0.03, 0.04);
    for (const double w_1 : {0.5, 4.0, 6.9}) {
        const auto omega_bar = [&](double t) { return asymmetric_top(J_bar, w_1, 5, t); };
        for (const double t : {0.0, 0.3, 2.0}) {
            const Vec3 w = omega_bar(t), L = J_bar.cwiseProduct(w);
            const Vec3 wdot = tests::derivative([&](double s) { return omega_bar(t + s); }, 1e-3);
            CHECK((J_bar.cwiseProduct(wdot) + w.cross(L)).norm() < 1e-9);
            CHECK(L.norm() == Approx(J_bar.cwiseProduct(omega_bar(0)).norm()).epsilon(1e-13));
            CHECK(w.dot(L) == Approx(omega_bar(0).dot(J_bar.cwiseProduct(omega_bar(0)))).epsilon(1e-13));
        }
        CHECK((omega_bar(0) - Vec3(w_1, 0, 5)).norm() < 1e-15);
    }
    CHECK_THROWS_WITH(asymmetric_top(J_bar, 9, 5, 1), Catch::Contains("k² at most one"));
    CHECK_THROWS_WITH(asymmetric_top(Vec3(3, 2, 1), 1, 1, 1), Catch::Contains("ascend"));
    CHECK_THROWS_WITH(asymmetric_top(J_bar, -1, 1, 1), Catch::Contains("positive"));
}
