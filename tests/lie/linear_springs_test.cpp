// SPDX-License-Identifier: GPL-3.0-or-later
/// Stability limits of linear springs and dampers: closed forms.

#include "lie/linear_springs.hpp"
#include "lie/loads.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace hilda;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

using Springs = lie::LinearSprings<Eigen::Dynamic>;
const double d_euler = lie::damping_factor(lie::LoadEvaluation::at_step),
             d_leapfrog = lie::damping_factor(lie::LoadEvaluation::extrapolated);

/// Whether the largest root of the characteristic polynomial x² + b x + c is within the unit circle
bool decays(double b, double c) { return std::abs(c) <= 1 && std::abs(b) <= 1 + c; }

}  // namespace

TEST_CASE("the stability limit of an undamped oscillator is 2/omega", "[lie][stable]")
{
    const double m = GENERATE(1e-6, 0.7, 3e4), k = GENERATE(1e-3, 5e8);
    const Springs spring{
        .W = MatrixXd::Constant(1, 1, 1 / m), .K = VectorXd::Constant(1, k), .D = VectorXd::Zero(1)};
    for (const double d : {d_euler, d_leapfrog})
        CHECK(spring.stable_step(d) == Approx(2 / std::sqrt(k / m)).epsilon(2e-12));
}

TEST_CASE("the stability limit of a damped oscillator is where the roots of the step leave the unit circle",
          "[lie][stable]")
{
    const double zeta = GENERATE(0., 0.1, 1., 20.), omega = 70, m = 3;
    const Springs spring{.W = MatrixXd::Constant(1, 1, 1 / m),
                         .K = VectorXd::Constant(1, m * omega * omega),
                         .D = VectorXd::Constant(1, 2 * zeta * omega * m)};
    CAPTURE(zeta);
    for (const double d : {d_euler, d_leapfrog})
        CHECK(spring.stable_step(d) ==
              Approx(2 / omega / (std::sqrt(1 + d * d * zeta * zeta) + d * zeta)).epsilon(2e-12));

    // symplectic Euler: v' = v - h (2 ζ ω v + ω² q), q' = q + h v'
    const double limit = spring.stable_step(d_euler);
    for (const double h : {limit * (1 - 1e-9), limit * (1 + 1e-9)}) {
        const double damping = 2 * zeta * omega * h, stiffness = omega * omega * h * h;
        CHECK(decays(stiffness + damping - 2, 1 - damping) == (h < limit));
        CHECK(spring.is_stable(h, d_euler) == (h < limit));
    }
}

TEST_CASE("no step is stable with a stiffness, damping or mass that is not finite", "[lie][stable]")
{
    const double bad = GENERATE(std::numeric_limits<double>::infinity(), std::nan(""));
    const Springs finite{
        .W = MatrixXd::Identity(2, 2), .K = VectorXd::Constant(2, 1e3), .D = VectorXd::Constant(2, 10)};
    Springs stiff = finite, damped = finite, light = finite;
    stiff.K[1] = damped.D[1] = light.W(1, 1) = bad;
    CHECK(finite.is_stable(1e-9, 1));
    for (const Springs& springs : {stiff, damped, light}) {
        CHECK_FALSE(springs.is_stable(1e-9, 1));
        CHECK(springs.stable_step(1) < 1e-14);
    }
    Springs largest = finite;
    largest.K[1] = 1e308;  // h² K overflows for a large h
    CHECK(largest.stable_step(1) < 1e-14);
}

TEST_CASE("the stability limit of coupled springs is that of their highest frequency", "[lie][stable]")
{
    // Three equal masses in a row, two springs between them: ω² = k/m and 3 k/m
    const double m = 0.5, k = 800;
    const MatrixXd W = (MatrixXd(2, 2) << 2 / m, -1 / m, -1 / m, 2 / m).finished();
    const Springs springs{.W = W, .K = VectorXd::Constant(2, k), .D = VectorXd::Zero(2)};
    CHECK(springs.stable_step(1) == Approx(2 / std::sqrt(3 * k / m)).epsilon(2e-12));

    lie::LinearSprings<6> six{.W = lie::LinearSprings<6>::Matrix::Zero(),
                              .K = lie::LinearSprings<6>::Vector::Zero(),
                              .D = lie::LinearSprings<6>::Vector::Zero()};
    six.W.block<2, 2>(3, 3) = W;
    six.K.segment<2>(3).setConstant(k);
    CHECK(six.stable_step(1) == springs.stable_step(1));
}

TEST_CASE(
    "springs without stiffness, with negative stiffness or between fixed bodies have no stability limit",
    "[lie][stable]")
{
    const double infinite = std::numeric_limits<double>::infinity();
    const VectorXd zero = VectorXd::Zero(1), one = VectorXd::Ones(1);
    const MatrixXd mass = MatrixXd::Ones(1, 1), fixed = MatrixXd::Zero(1, 1);
    CHECK(Springs{mass, zero, zero}.stable_step(1) == infinite);
    CHECK(Springs{mass, -one, zero}.stable_step(1) == infinite);
    CHECK(Springs{fixed, one, one}.stable_step(1) == infinite);
}

TEST_CASE("a damper has its stability limit also beside a spring of negative stiffness", "[lie][stable]")
{
    const double m = 2, c = 30, k = GENERATE(0., -1e-3, -50.);
    const Springs springs{
        .W = MatrixXd::Constant(1, 1, 1 / m), .K = VectorXd::Constant(1, k), .D = VectorXd::Constant(1, c)};
    for (const double d : {d_euler, d_leapfrog})
        CHECK(springs.stable_step(d) ==
              Approx(4 * m / (d * c + std::sqrt(d * d * c * c + 4 * m * k))).epsilon(2e-12));
}
