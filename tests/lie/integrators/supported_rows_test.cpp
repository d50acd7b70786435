// SPDX-License-Identifier: GPL-3.0-or-later
/// Each scheme integrates the kinds of rows that it declares, and refuses systems with others.

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/sliding_body.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

namespace {

/// A body whose velocity along x is prescribed, v_x = ν(t) = sin t, by a nonholonomic row
class TowedBody final : public lie::System {
public:
    static constexpr double m = 2;
    static inline const Vec3 F = {1, -3, 0.5};

    TowedBody()
    {
        inertia.m = {m};
        inertia.J_bar = {Vec3(0.05, 0.08, 0.06).asDiagonal()};
        rows_pattern.entry.push_back({});
        rows_pattern.start.push_back(1);
        rows_pattern.velocity_rows = 1;
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads& out) const override { out.F[0] = F, out.n_bar[0].setZero(); }
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void variation(const lie::State&, lie::Rows& out) const override { out.entry[0].r = Vec3::UnitX(); }
    void nu(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override { out[0] = std::sin(x.t); }
    void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out[0] = std::cos(x.t);
    }

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

/// x with its accelerations and multipliers
lie::State consistent(const lie::System& system, lie::State x)
{
    lie::Saddle K(system);
    lie::solve_accelerations(system, K, x);
    return x;
}

/// The state at `end`, after steps h [s] from a consistent state
lie::State state_at(double end, double h, const lie::System& system, const lie::Scheme& s,
                    const lie::State& x)
{
    return lie::march(x, *s.make(system, {}), lie::TimeGrid::over(end, h, end)).row.back();
}

/// The schemes that take the rows of the system. The others must refuse it.
std::vector<lie::Scheme> schemes_for(const lie::System& system)
{
    std::vector<lie::Scheme> chosen;
    for (const lie::Scheme& s : lie::schemes()) {
        INFO(s.name);
        if (s.takes(system))
            chosen.push_back(s);
        else
            CHECK_THROWS_AS(s.make(system, {}), lie::InvalidInput);
    }
    CHECK_FALSE(chosen.empty());
    return chosen;
}

}  // namespace

TEST_CASE("a scheme with friction rows decelerates a sliding body by mu g, and the others refuse it",
          "[lie][bounded]")
{
    const tests::SlidingBody system;
    const Vec3 v_0(3, -1, 0);
    const lie::State x = consistent(system, tests::SlidingBody::start(v_0));
    const Vec3 deceleration = tests::SlidingBody::mu * tests::SlidingBody::g * v_0.normalized();
    CHECK((x.body[0].rddot + deceleration).norm() < 1e-4 * deceleration.norm());
    const double end = 0.5;
    for (const lie::Scheme& s : schemes_for(system)) {
        INFO(s.name);
        const lie::State y = state_at(end, 1e-3, system, s, x);
        CHECK((y.body[0].rdot - (v_0 - end * deceleration)).norm() < 1e-3);
        CHECK((y.body[0].r - (end * v_0 - 0.5 * end * end * deceleration)).norm() < 2e-3);  // order 1: ½ h Δv
    }
}

TEST_CASE("a scheme with nonholonomic rows follows a prescribed velocity, and the others refuse it",
          "[lie][nonholonomic]")
{
    const TowedBody system;
    lie::State x;
    x.body.resize(1);
    x.body[0].omega_bar = {0.2, 0.1, 4};
    x.lambda = Eigen::VectorXd::Zero(1);
    x = consistent(system, x);
    const double end = 2, h = 1e-3;
    for (const lie::Scheme& s : schemes_for(system)) {
        INFO(s.name);
        const lie::State y = state_at(end, h, system, s, x);
        const double tolerance = std::pow(h, std::min(s.order, 2));
        CHECK(std::abs(y.body[0].rdot.x() - std::sin(end)) < tolerance);
        CHECK(std::abs(y.body[0].r.x() - (1 - std::cos(end))) < tolerance);
        // The velocities of rA-half-1 at the nodes alternate by O(h), and so its multipliers by O(1).
        if (s.name == "rA-half-1") continue;
        const double lambda =
            TowedBody::F.x() - TowedBody::m * std::cos(end);  // m r̈ + λ e_x = F, r̈_x = cos t
        CHECK(std::abs(y.lambda[0] - lambda) < 5 * std::pow(h, std::min(s.order_lambda, 2)) * TowedBody::m);
    }
}
