// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/anderson.hpp"

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using lie::Anderson;

namespace {

/// The equation A z = b, and the correction e = b - A z of a Newton matrix that is the identity
struct Linear {
    Eigen::MatrixXd A;
    Eigen::VectorXd b;

    explicit Linear(int n) : A(n, n), b(n)
    {
        for (int i = 0; i < n; ++i) {
            b[i] = 1 + 0.1 * i;
            for (int j = 0; j < n; ++j) A(i, j) = (i == j ? 3 : 0) + std::sin(1 + i + 3 * j);
        }
    }
    Eigen::VectorXd correction(const Eigen::VectorXd& z) const { return b - A * z; }
};

}  // namespace

TEST_CASE("Anderson's acceleration solves a linear equation in one correction more than it has unknowns",
          "[lie][anderson]")
{
    for (const int n : {1, 3, 6}) {
        const Linear equation(n);
        Anderson anderson(n, n);
        for (const double start : {0., 7.}) {
            Eigen::VectorXd z = Eigen::VectorXd::Constant(n, start), plain = z, e;
            anderson.start();
            for (int k = 0; k < n + 2; ++k) {
                e = equation.correction(z);
                anderson.accelerate(z, e);
                z += e;
                plain += equation.correction(plain);
            }
            INFO(n << " unknowns");
            CHECK(equation.correction(z).norm() < 1e-9);
            CHECK(equation.correction(plain).norm() > 1);  // without it the iteration diverges
        }
    }
}

TEST_CASE("Anderson's acceleration does not allocate memory", "[lie][anderson][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("skipped: a sanitizer replaces the allocator");
        return;
    }
    const Linear equation(30);
    Anderson anderson(30, 20);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(30), e = equation.b;
    const long taken = tests::allocations_during([&] {
        anderson.start();
        for (int k = 0; k < 20; ++k) {
            e.noalias() = equation.b;
            e.noalias() -= equation.A * z;
            anderson.accelerate(z, e);
            z += e;
        }
    });
    CHECK(taken == 0);
}

TEST_CASE("steps in which a body turns far converge", "[lie][newton][anderson]")
{
    // 1.3 rad in a step. The Newton matrix of the node does not contract there.
    const tests::SpinningTop top;
    for (const char* name : {"rA-half-1-kick", "rA-half-1-momentum", "rA-rattle"}) {
        lie::State x = top.start();
        const auto integrator = lie::scheme(name).make(top, {});
        INFO(name);
        CHECK_NOTHROW(integrator->step(x, 0.2));
        Eigen::VectorXd Phi(3);
        top.phi(x, Phi);
        CHECK(Phi.norm() < 1e-10);
    }
}
