// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-radau-5: its coefficients, its stages and stiff loads.

#include "lie/steps/radau_step.hpp"
#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/lie/one_body_state.hpp"
#include "tests/support/driven_top.hpp"
#include "tests/support/sprung_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::RadauStep;
using lie::State;
using lie::Vec3;
using tests::numbers;

namespace {

/// Gives access to the stages of a step and to its continuous extension.
class OpenStep final : public RadauStep {
public:
    using RadauStep::RadauStep;
    /// The state of stage i of the last step, which started at x
    State stage(const State& x, int i, double h) const
    {
        State at = x;
        at.t = x.t + c[i] * h;
        at.body[0].r += last.q.col(i).head<3>();
        at.body[0].A *= lie::exp(last.q.col(i).tail<3>());
        at.body[0].rdot += last.v.col(i).head<3>();
        at.body[0].omega_bar += last.v.col(i).tail<3>();
        at.lambda = last.lambda.col(i);
        return at;
    }
    State inside(const State& x, double s, double h)
    {
        State at = x_n = x;
        at.history.resize(0);
        step(at, h);
        x_n = x;
        interpolate(at, s, h);
        return at;
    }
};

}  // namespace

TEST_CASE("the coefficients are those of the Radau IIA method of three stages", "[lie][radau]")
{
    Eigen::Matrix3d A_inverse, T, T_inverse, powers, integrals;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            A_inverse(i, j) = RadauStep::A_inverse[i][j];
            T(i, j) = RadauStep::T[i][j], T_inverse(i, j) = RadauStep::T_inverse[i][j];
            powers(i, j) = std::pow(RadauStep::c[i], j);  // c^(q-1), q = j + 1
            integrals(i, j) = std::pow(RadauStep::c[i], j + 1) / (j + 1);
        }
    CHECK((A_inverse * integrals - powers).norm() < 1e-13);
    Eigen::Matrix3d diagonal = Eigen::Matrix3d::Zero();
    const double a = RadauStep::mu_complex.real(), b = RadauStep::mu_complex.imag();
    diagonal(0, 0) = RadauStep::mu;
    diagonal.bottomRightCorner<2, 2>() << a, -b, b, a;
    CHECK((T * T_inverse - Eigen::Matrix3d::Identity()).norm() < 1e-14);
    CHECK((T * diagonal * T_inverse - A_inverse).norm() < 1e-13);
    // order 5: the weights, the last row of A, integrate polynomials of degree 4
    const Eigen::RowVector3d weights = A_inverse.inverse().row(2);
    for (int q = 1; q <= 5; ++q) {
        double sum = 0;
        for (int j = 0; j < 3; ++j) sum += weights[j] * std::pow(RadauStep::c[j], q - 1);
        CHECK(sum == Approx(1. / q).epsilon(1e-14));
    }
}

TEST_CASE("each stage satisfies the collocation equations and the velocity constraints", "[lie][radau]")
{
    const tests::DrivenTop top;
    const State start = top.start();
    OpenStep integrator(top, {.tolerance = 1e-13});
    const double h = 0.02;
    State end = start;
    integrator.step(end, h);
    lie::Rows C = top.pattern();
    Eigen::VectorXd nu(3);
    Eigen::Matrix<double, 12, 3> z, slope;
    for (int i = 0; i < 3; ++i) {
        const State x = integrator.stage(start, i, h);
        const lie::Motion &body = x.body[0], &from = start.body[0];
        top.variation(x, C);
        top.nu(x, nu);
        Eigen::Matrix<double, 6, 1> v, force = Eigen::Matrix<double, 6, 1>::Zero();
        v << body.rdot, body.omega_bar;
        for (int k = 0; k < 3; ++k) CHECK(C.dot(k, v) == Approx(nu[k]).margin(1e-11));
        const Vec3 theta = lie::log(from.A.transpose() * body.A);
        z.col(i) << body.r - from.r, theta, body.rdot - from.rdot, body.omega_bar - from.omega_bar;
        lie::Loads loads(1);
        top.loads(x, loads);
        C.add_transpose(-1, x.lambda, force);
        const lie::Mat3& J_bar = top.mass().J_bar[0];
        slope.col(i) << body.rdot, lie::right_jacobian_inverse(theta) * body.omega_bar,
            (loads.F[0] + force.head<3>()) / top.mass().m[0],
            J_bar.inverse() * (loads.tau_bar(0, J_bar, body.omega_bar) + force.tail<3>());
    }
    Eigen::Matrix3d A_inverse;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) A_inverse(i, j) = RadauStep::A_inverse[i][j];
    CHECK((z * A_inverse.transpose() / h - slope).norm() < 1e-8);
    // Positions are projected after the step only: their error at the stages is that of the method.
    Eigen::VectorXd Phi(3);
    top.phi(end, Phi);
    CHECK(Phi.norm() < 1e-14);
    top.phi(integrator.stage(start, 0, h), Phi);
    CHECK(Phi.norm() > 1e-13);
    CHECK(Phi.norm() < 1e-4);
}

TEST_CASE("the continuous extension of rA-radau-5 is of order 3", "[lie][radau][order]")
{
    const tests::DrivenTop top;
    const State start = top.start();
    const auto error = [&](double h) {
        OpenStep integrator(top, {.tolerance = 1e-14});
        const State inside = integrator.inside(start, 0.37, h);
        const auto fine = lie::scheme("rA-dop853").make(top, {});
        State exact = start;
        for (int n = 0; n < 4; ++n) fine->step(exact, 0.37 * h / 4);
        CHECK(inside.t == Approx(exact.t));
        return (numbers(inside) - numbers(exact)).head(18).norm();
    };
    const double coarse = error(4e-2), fine = error(2e-2);
    INFO(coarse << ' ' << fine);
    CHECK(std::log2(coarse / fine) == Approx(4).margin(0.3));  // of the local error
}

TEST_CASE("rA-radau-5 integrates stiff loads with the error of its tolerance", "[lie][radau]")
{
    const tests::SpinningTop joint;
    const auto run = [](const lie::System& system, const State& start, const char* name, double rtol) {
        const auto integrator = lie::scheme(name).with_adaptive_steps().make(system, {.rtol = rtol});
        const State end = lie::march(start, *integrator, lie::TimeGrid::over(0.5, 0.5)).row.back();
        return std::pair(end, integrator->statistics().steps);
    };
    const State exact = run(joint, joint.start(), "rA-dop853", 1e-12).first;
    for (const double stiffness : {1e6, 1e8, 1e10})
        for (const double damping : {0., 1e5}) {
            const tests::SprungTop top(stiffness, damping);
            const auto [end, steps] = run(top, top.start(), "rA-radau-5", 1e-6);
            INFO("k " << stiffness << ", c " << damping << ": " << steps << " steps, error "
                      << (end.body[0].r - exact.body[0].r).norm());
            CHECK(steps < (stiffness < 1e9 ? 600 : 2000));  // an explicit scheme takes 0.5 s √(k/m) = 35000
            // the deflection is up to 100 N / k
            CHECK((end.body[0].r - exact.body[0].r).norm() < 3e-5 + 300 / stiffness);
        }
}

TEST_CASE("a run of fixed step continues from each of its nodes with the same digits", "[lie][radau][resume]")
{
    const tests::DrivenTop driven;
    const tests::SprungTop sprung(1e6, 10);
    const auto check = [](const lie::System& system, const State& start, const char* name, double h) {
        const auto whole = lie::scheme(name).make(system, {});
        State x = start;
        std::vector<State> nodes = {x};
        for (int n = 0; n < 8; ++n) whole->step(x, h), nodes.push_back(x);
        for (size_t n = 0; n < 8; ++n) {
            State y = nodes[n];
            const auto resumed = lie::scheme(name).make(system, {});
            if (whole->pivots() != nullptr && !whole->pivots()->body.empty())
                resumed->choose_pivots(*whole->pivots(), h);
            for (size_t k = n; k < 8; ++k) resumed->step(y, h);
            INFO(name << " from node " << n);
            CHECK(numbers(y) == numbers(x));
            CHECK(y.history == x.history);
        }
    };
    for (const char* name : {"rA-radau-5", "rA-genalpha"}) {
        check(driven, driven.start(), name, 0.01);
        check(sprung, sprung.start(), name, 0.01);
    }
}
