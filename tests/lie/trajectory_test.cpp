// SPDX-License-Identifier: GPL-3.0-or-later
/// The nodes of a march: the start, the times, and the limit of the rotation in a step.

#include "lie/trajectory.hpp"

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using lie::Vec3;

TEST_CASE("the node at the start has the velocities, accelerations and multipliers of the initial state",
          "[lie][march]")
{
    const tests::SpinningTop top;
    const lie::State start = top.start();
    for (const lie::Scheme& s : lie::schemes()) {
        INFO(s.name);
        const auto integrator = s.make(top, {});
        const lie::State first = lie::march(start, *integrator, lie::TimeGrid::over(0.05, 1e-2)).row.front();
        const lie::Motion &a = first.body[0], &b = start.body[0];
        CHECK(first.t == 0);
        CHECK(a.r == b.r);
        CHECK(a.A == b.A);
        CHECK(a.rdot == b.rdot);
        CHECK(a.omega_bar == b.omega_bar);
        CHECK(a.rddot == b.rddot);
        CHECK(a.omegadot_bar == b.omegadot_bar);
        CHECK(first.lambda == start.lambda);
    }
}

TEST_CASE("the times of the nodes are the doubles nearest to the decimals, also after many steps",
          "[lie][march]")
{
    const tests::SpinningTop top(true);
    for (const double h : {1e-3, 2e-4}) {
        const auto integrator = lie::scheme("rA-half-1").make(top, {});
        const lie::Trajectory run = lie::march(top.start(), *integrator, lie::TimeGrid::over(3, h, 0.1));
        REQUIRE(run.row.size() == 31);
        for (int k = 0; k <= 30; ++k) CHECK(run.row[k].t == k / 10.);  // the quotient is the nearest double
    }
    // a step whose reciprocal is no integer: the error is that of one product
    const double h = 3e-4;
    const auto integrator = lie::scheme("rA-half-1").make(top, {});
    const lie::Trajectory run = lie::march(top.start(), *integrator, lie::TimeGrid::over(3, h, 0.3));
    for (int k = 0; k <= 10; ++k) CHECK(run.row[k].t == k * 1000 * h);
}

TEST_CASE("a step in which a body rotates by half a turn or more is refused", "[lie][march]")
{
    // The equations of an implicit scheme have several solutions then. 3.5 rad is 2.78 rad the other way
    // round.
    const tests::SpinningTop top(true);
    const double h = 1e-2;
    for (const char* name :
         {"rA-full-1", "rA-full-1-exact", "rA-genalpha", "rA-rkmk-4", "rA-half-1-momentum"})
        for (const double angle : {2.8, 3.1, 3.2, 3.5, 6.2}) {
            lie::State x = top.start();
            x.body[0].omega_bar = Vec3(0, 0, angle / h);  // about a principal axis: the rate is constant
            x.body[0].omegadot_bar.setZero();
            const auto integrator = lie::scheme(name).make(top, {});
            lie::March march(x, *integrator, h);
            INFO(name << ", angle " << angle);
            if (angle < std::numbers::pi)
                CHECK_NOTHROW(march.advance({}));
            else
                CHECK_THROWS_AS(march.advance({}), lie::NumericalFailure);
            CHECK(march.number() == (angle < std::numbers::pi ? 1 : 0));
        }
}

TEST_CASE("a step after which an orientation is not a rotation is refused", "[lie][march]")
{
    /// Leaves all as it is but A, which it multiplies by a factor.
    class Scales final : public lie::Integrator {
    public:
        Scales(const lie::System& top, double factor) : top(top), factor(factor) {}
        const lie::System& system() const override { return top; }
        int step(lie::State& x, double /*h*/) override
        {
            for (lie::Motion& body : x.body) body.A *= factor;
            return 1;
        }
        lie::Statistics statistics() const override { return {}; }

    private:
        const lie::System& top;
        const double factor;
    };
    const tests::SpinningTop top;
    const auto end = [&](double factor) {
        Scales integrator(top, factor);
        return lie::march(top.start(), integrator, lie::TimeGrid::over(0.05, 1e-2));
    };
    CHECK_NOTHROW(end(1 + 1e-8));
    for (const double factor : {1 + 1e-5, -1., 0.}) {
        INFO(factor);
        try {
            end(factor);
            FAIL("accepted");
        } catch (const lie::NumericalFailure& failure) {
            CHECK(failure.status == "not_a_rotation");
            CHECK_THAT(failure.what(), Catch::Contains("the orientation A after the step is not a rotation"));
        }
    }
}

TEST_CASE("a grid with a huge output interval has the rows of its ends", "[lie][trajectory]")
{
    for (const double dt : {1e20, 1e300}) {
        const lie::TimeGrid grid = lie::TimeGrid::over(1, 1e-3, dt);
        CHECK(grid.is_row(0));
        CHECK_FALSE(grid.is_row(1));
        CHECK(grid.is_row(grid.steps));
    }
}
