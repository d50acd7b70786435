// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/least_squares.hpp"

#include "lie/check.hpp"

#include <Eigen/QR>

#include <catch2/catch.hpp>

#include <cmath>
#include <stdexcept>

using namespace hilda;
using Catch::Matchers::Contains;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// y = p₀ exp(-p₁ t) at t = 0, 0.1, …, 2, with data of p = (2, 3)
reference::LeastSquaresProblem decay(std::vector<reference::BoundedUnknown> unknowns)
{
    reference::LeastSquaresProblem problem;
    problem.unknowns = std::move(unknowns);
    problem.residuals = [](const VectorXd& p, VectorXd& r) {
        r.resize(21);
        for (int k = 0; k <= 20; ++k) r[k] = p[0] * std::exp(-p[1] * 0.1 * k) - 2 * std::exp(-0.3 * k);
        return true;
    };
    problem.derivatives = [](const VectorXd& p, const VectorXd&, MatrixXd& J) {
        for (int k = 0; k <= 20; ++k) {
            J(k, 0) = std::exp(-p[1] * 0.1 * k);
            J(k, 1) = -0.1 * k * p[0] * J(k, 0);
        }
    };
    return problem;
}

}  // namespace

TEST_CASE("a linear least-squares problem has the solution of the normal equations")
{
    const MatrixXd A = (MatrixXd(5, 2) << 1, 2, 3, -1, 0, 4, 2, 2, -1, 1).finished();
    const VectorXd b = (VectorXd(5) << 1, -2, 3, 0, 5).finished();
    reference::LeastSquaresProblem problem;
    problem.unknowns = {{.start = 10}, {.start = -10, .scale = 5}};
    problem.residuals = [&](const VectorXd& p, VectorXd& r) {
        r = A * p - b;
        return true;
    };
    problem.derivatives = [&](const VectorXd&, const VectorXd&, MatrixXd& J) { J = A; };
    const auto solution = reference::minimise(problem);
    CHECK(solution.has_converged);
    CHECK((solution.p - A.colPivHouseholderQr().solve(b)).norm() < 1e-9);
    CHECK((solution.residuals - (A * solution.p - b)).norm() < 1e-12);
}

TEST_CASE("least squares finds a minimum between bounds and at a bound")
{
    const double inf = std::numeric_limits<double>::infinity();
    for (const auto& [low, high] : {std::pair{-inf, inf}, {0., inf}, {-inf, 7.}, {0., 7.}}) {
        const auto solution = reference::minimise(
            decay({{.start = 1, .low = low, .high = high}, {.start = 1, .low = low, .high = high}}));
        CAPTURE(low, high, solution.reason);
        CHECK(solution.has_converged);
        CHECK((solution.p - Eigen::Vector2d(2, 3)).norm() < 1e-8);
    }
    const auto at_bound = reference::minimise(decay({{.start = 1}, {.start = 1, .low = 0, .high = 2.5}}));
    CHECK(at_bound.has_converged);
    CHECK(at_bound.p[1] <= 2.5);
    CHECK(at_bound.p[1] > 2.5 - 1e-6);
    // The best amplitude for that rate: linear in p₀
    double above = 0, below = 0;
    for (int k = 0; k <= 20; ++k)
        above += 2 * std::exp(-0.3 * k) * std::exp(-0.25 * k), below += std::exp(-0.5 * k);
    CHECK(at_bound.p[0] == Approx(above / below).epsilon(1e-6));
}

TEST_CASE("least squares avoids unknowns at which there are no residuals")
{
    auto problem = decay({{.start = 1}, {.start = 8}});
    int refused = 0;
    problem.residuals = [&, all = problem.residuals](const VectorXd& p, VectorXd& r) {
        if (p[1] < 2.9) ++refused;
        return p[1] >= 2.9 && all(p, r);
    };
    const auto solution = reference::minimise(problem);
    CHECK(refused > 0);
    CHECK(solution.has_converged);
    CHECK((solution.p - Eigen::Vector2d(2, 3)).norm() < 1e-8);
    problem.unknowns[1].start = 2;
    CHECK_THROWS_WITH(reference::minimise(problem), Contains("cannot be computed at the start"));
}

TEST_CASE("least squares refuses invalid problems and passes exceptions on")
{
    CHECK_THROWS_WITH(reference::minimise(decay({{.start = 1}, {.start = 3, .low = 3}})),
                      Contains("unknown 2: the start must be finite and between the bounds, got 3"));
    CHECK_THROWS_WITH(reference::minimise(decay({{.start = 1, .scale = 0}, {.start = 3}})),
                      Contains("unknown 1: the scale must be positive"));
    auto problem = decay({{.start = 1}, {.start = 1}});
    problem.derivatives = [](const VectorXd&, const VectorXd&, MatrixXd&) {
        throw std::domain_error("here");
    };
    CHECK_THROWS_WITH(reference::minimise(problem), "here");
    problem.residuals = [](const VectorXd&, VectorXd& r) {
        r = VectorXd::Zero(1);
        return true;
    };
    CHECK_THROWS_AS(reference::minimise(problem), lie::InvalidInput);
}

TEST_CASE("confidence factors are those of the tables")
{
    CHECK(reference::confidence_factor(0.95, 10) == Approx(2.228138852));
    CHECK(reference::confidence_factor(0.95, 1) == Approx(12.70620474));
    CHECK(reference::confidence_factor(0.95, 0) == Approx(1.959963985));
}
