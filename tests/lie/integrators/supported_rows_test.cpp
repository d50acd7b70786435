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

}  // namespace

TEST_CASE("a scheme with friction rows decelerates a sliding body by mu g, and the others refuse it",
          "[lie][bounded]")
{
    const tests::SlidingBody system;
    const Vec3 v_0(3, -1, 0);
    const double end = 0.5, h = 1e-3;
    int with_friction = 0;
    for (const lie::Scheme& s : lie::schemes()) {
        INFO(s.name);
        if (!s.regularised) {
            CHECK_THROWS_AS(s.make(system, {}), lie::InvalidInput);
            continue;
        }
        ++with_friction;
        lie::State x = tests::SlidingBody::start(v_0);
        lie::Saddle K(system);
        lie::solve_accelerations(system, K, x);
        const Vec3 deceleration = tests::SlidingBody::mu * tests::SlidingBody::g * v_0.normalized();
        CHECK((x.body[0].rddot + deceleration).norm() < 1e-4 * deceleration.norm());
        const auto integrator = s.make(system, {});
        const lie::State y = lie::march(x, *integrator, lie::TimeGrid::over(end, h, end)).row.back();
        CHECK((y.body[0].rdot - (v_0 - end * deceleration)).norm() < 1e-3);
        CHECK((y.body[0].r - (end * v_0 - 0.5 * end * end * deceleration)).norm() < 2e-3);  // order 1: ½ h Δv
    }
    CHECK(with_friction > 0);
}

TEST_CASE("a scheme with nonholonomic rows follows a prescribed velocity, and the others refuse it",
          "[lie][nonholonomic]")
{
    const TowedBody system;
    const double end = 2;
    int nonholonomic = 0;
    for (const lie::Scheme& s : lie::schemes()) {
        INFO(s.name);
        if (!s.nonholonomic) {
            CHECK_THROWS_AS(s.make(system, {}), lie::InvalidInput);
            continue;
        }
        ++nonholonomic;
        const auto error = [&](double h, double& of_lambda) {
            lie::State x;
            x.body.resize(1);
            x.body[0].omega_bar = {0.2, 0.1, 4};
            x.lambda = Eigen::VectorXd::Zero(1);
            lie::Saddle K(system);
            lie::solve_accelerations(system, K, x);
            const auto integrator = s.make(system, {});
            const lie::State y = lie::march(x, *integrator, lie::TimeGrid::over(end, h, end)).row.back();
            of_lambda = std::abs(y.lambda[0] - (TowedBody::F.x() - TowedBody::m * std::cos(end)));
            // m r̈ + λ e_x = F with r̈_x = cos t
            return std::max(std::abs(y.body[0].rdot.x() - std::sin(end)),
                            std::abs(y.body[0].r.x() - (1 - std::cos(end))));
        };
        double of_lambda = 0;
        const double h = 1e-3, of_motion = error(h, of_lambda);
        CHECK(of_motion < std::pow(h, std::min(s.order, 2)));
        // The velocities of rA-half-1 at the nodes alternate by O(h), and so its multipliers by O(1).
        if (s.name == "rA-half-1") continue;
        CHECK(of_lambda < 5 * std::pow(h, std::min(s.order_lambda, 2)) * TowedBody::m);
    }
    CHECK(nonholonomic > 0);
}
