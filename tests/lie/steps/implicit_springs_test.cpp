// SPDX-License-Identifier: GPL-3.0-or-later
/// Springs and dampers far beyond the stability limit of explicit loads: closed forms of one oscillator.

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/system.hpp"
#include "lie/trajectory.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

namespace {

/// A body on a spring and a damper along x
class Oscillator final : public lie::System {
public:
    Oscillator(double k, double c, bool implicit = true) : k(k), c(c), implicit(implicit)
    {
        inertia.m = {m};
        inertia.J_bar = {lie::Mat3::Identity()};
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return none; }
    void loads(const lie::State& x, lie::Loads& out) const override
    {
        out.F[0] = -(k * x.body[0].r.x() + c * x.body[0].rdot.x()) * Vec3::UnitX();
        out.n_bar[0].setZero();
    }
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const lie::State&, lie::Rows&) const override {}
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    lie::Springs spring_pattern() const override
    {
        lie::Springs springs;
        if (!implicit) return springs;
        springs.rows.entry.push_back({});
        springs.rows.start.push_back(1);
        springs.rows.regularised = {0};
        springs.rows.velocity_rows = springs.rows.springs = 1;
        springs.stiffness = springs.damping = springs.gamma = {0};
        return springs;
    }
    void update_springs(const lie::State&, lie::Springs& out) const override
    {
        out.rows.entry[0].r = Vec3::UnitX();
        out.stiffness[0] = k, out.damping[0] = c, out.gamma[0] = 0;
    }
    double potential_energy(const lie::State& x) const override
    {
        return k / 2 * x.body[0].r.x() * x.body[0].r.x();
    }

    lie::State start(double x, double v) const
    {
        lie::State state;
        state.body.resize(1);
        state.body[0].r.x() = x, state.body[0].rdot.x() = v;
        lie::Saddle K(*this);
        lie::solve_accelerations(*this, K, state);
        return state;
    }

    static constexpr double m = 2;

private:
    const double k, c;
    const bool implicit;
    lie::Mass inertia;
    lie::Rows none;
};

lie::Trajectory nodes(const Oscillator& system, const lie::Scheme& s, double x, double v, double h, int steps)
{
    const auto integrator = s.make(system, {.tolerance = 1e-13});
    return lie::march(system.start(x, v), *integrator, lie::TimeGrid::over(steps * h, h, h));
}

}  // namespace

TEST_CASE("the first-order scheme takes implicit springs as backward Euler does", "[lie][springs]")
{
    const double k = GENERATE(0., 1e6), c = GENERATE(0., 40., 1e5), h = 0.01;
    const Oscillator system(k, c);
    const lie::Trajectory run = nodes(system, lie::scheme("rA-half-1"), 0.1, -3, h, 30);
    double x = 0.1, v = -3;
    REQUIRE(run.row.size() == 31);
    for (size_t n = 1; n < run.row.size(); ++n) {
        v = (Oscillator::m * v - h * k * x) / (Oscillator::m + h * c + h * h * k);
        x += h * v;
        CHECK(run.row[n].body[0].r.x() == Approx(x).epsilon(1e-9).margin(1e-12));
        CHECK(run.row[n].body[0].rdot.x() == Approx(v).epsilon(1e-9).margin(1e-10));
    }
}

TEST_CASE("the schemes of second order conserve the energy of an oscillator at any step", "[lie][springs]")
{
    const double k = 5e5, omega = std::sqrt(k / Oscillator::m), h = GENERATE(0.1, 1.9, 20.) / omega;
    const Oscillator system(k, 0);
    int schemes = 0;
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::springs) || s.order < 2) continue;
        ++schemes;
        INFO(s.name << ", h omega = " << h * omega);
        const lie::Trajectory run = nodes(system, s, 0.02, 4, h, 400);
        const double energy = lie::energy(system, run.row[0]);
        CHECK(energy == Approx(116));
        double largest = 0, turned = 1;
        for (const lie::State& x : run.row) {
            largest = std::max(largest, std::abs(lie::energy(system, x) / energy - 1));
            turned = std::min(turned, x.body[0].r.x() / 0.02);
        }
        CHECK(largest < 1e-9);
        CHECK(turned < -0.9);  // it oscillates
    }
    CHECK(schemes > 0);
}

TEST_CASE("the schemes of second order let a damped body decay by the exact factor of a step",
          "[lie][springs]")
{
    const double per_step = GENERATE(1e-3, 0.3, 4.), h = 0.01, c = per_step * Oscillator::m / h;
    const Oscillator system(0, c);
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::springs) || s.order < 2) continue;
        INFO(s.name << ", h c/m = " << per_step);
        const lie::Trajectory run = nodes(system, s, 0, 5, h, 6);
        for (size_t n = 2; n < run.row.size(); ++n)
            CHECK(run.row[n].body[0].rdot.x() ==
                  Approx(run.row[n - 1].body[0].rdot.x() * std::exp(-per_step)).epsilon(1e-9));
    }
}

TEST_CASE("a spring or damper of negative coefficient is evaluated as an explicit load", "[lie][springs]")
{
    const double h = 1e-3;
    const Oscillator implicit(-50, -3), explicitly(-50, -3, false);
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::springs)) continue;
        INFO(s.name);
        const lie::State a = nodes(implicit, s, 0.1, 1, h, 50).row.back(),
                         b = nodes(explicitly, s, 0.1, 1, h, 50).row.back();
        CHECK(a.body[0].r.x() == Approx(b.body[0].r.x()).epsilon(1e-13));
        CHECK(a.body[0].rdot.x() == Approx(b.body[0].rdot.x()).epsilon(1e-13));
        CHECK(a.body[0].r.x() > 0.15);
    }
}
