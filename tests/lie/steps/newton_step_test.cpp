// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/newton_step.hpp"

#include "lie/check.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <functional>

using namespace hilda;

namespace {

/// Newton's method whose correction k has a given norm
class Iteration : public lie::NewtonStep {
public:
    Iteration(const lie::System& system, const lie::Settings& settings) : NewtonStep(system, settings) {}

    /// Number of corrections. Throws NoConvergence.
    int corrections(const std::function<double(int)>& norm)
    {
        x_n.body.resize(1);
        const Eigen::VectorXd none(0);
        for (int k = 1; k <= most_iterations; ++k)
            if (converged(k, norm(k), none, 0)) return k;
        no_convergence("test", correction, x_n);
    }
    int step(lie::State&, double) override { return 0; }
    lie::Statistics statistics() const override { return {}; }
};

}  // namespace

TEST_CASE("Newton's method ends where the error that remains is below the tolerance", "[lie][newton]")
{
    const tests::SpinningTop top(true);
    constexpr double tolerance = 1e-10;
    Iteration newton(top, {.tolerance = tolerance});
    for (const double rate : {1e-3, 0.1, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
        const auto norm = [&](int k) { return 1e-9 * std::pow(rate, k); };
        const int k = newton.corrections(norm);
        CAPTURE(rate, k);
        // The sum of the following corrections is the error of the iterate.
        const auto error = [&](int after) { return norm(after) * rate / (1 - rate); };
        CHECK(norm(k) < tolerance);
        if (k < 30) CHECK(error(k) < tolerance);
        if (k > 1) CHECK((norm(k - 1) >= tolerance || error(k - 1) >= tolerance));
    }
}

TEST_CASE("Newton's method ends where its corrections no longer decrease below the tolerance",
          "[lie][newton]")
{
    const tests::SpinningTop top(true);
    Iteration newton(top, {.tolerance = 1e-10});
    CHECK(newton.corrections([](int k) { return k < 3 ? 1e-3 : 6e-11; }) == 3);
    CHECK(newton.corrections([](int k) { return std::max(1e-9 * std::pow(0.8, k), 6e-11); }) == 14);
    // After the last iteration the correction decides, as it does with a fast convergence.
    CHECK(newton.corrections([](int k) { return 4e-10 * std::pow(0.93, k); }) == 30);
}

TEST_CASE("Newton's method that fails says by which factor its corrections change", "[lie][newton]")
{
    const tests::SpinningTop top(true);
    Iteration newton(top, {.tolerance = 1e-10});
    for (const double rate : {0.95, 1.3}) try {
            newton.corrections([&](int k) { return std::pow(rate, k); });
            FAIL("it has converged");
        } catch (const lie::NoConvergence& failure) {
            CHECK(failure.rate == Approx(rate));
            CHECK(failure.iterations == 30);
        }
}
