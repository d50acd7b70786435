// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle and its compositions: symmetry and order with loads that depend on velocities, long runs.

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <string>

using namespace hilda;
using lie::Vec3;

namespace {

/// A top with a damper in its joint, n̄ = -c ω̄ - c' |ω̄| ω̄, and drag on its centre of mass, F = m g - d ṙ
class DampedTop final : public lie::System {
public:
    explicit DampedTop(double c, bool has_history = false, double preload = 0)
        : c(c), has_history(has_history), preload(preload)
    {}

    const lie::Mass& mass() const override { return top.mass(); }
    const lie::Rows& pattern() const override { return top.pattern(); }
    void loads(const lie::State& x, lie::Loads& out) const override
    {
        top.loads(x, out);
        const lie::Motion& body = x.body[0];
        const Vec3 pull(preload, 0, 0);
        out.F[0] = (out.F[0] - 2 * c * body.rdot + pull) - pull;
        out.n_bar[0] -= (c + 0.1 * c * body.omega_bar.norm()) * body.omega_bar;
    }
    lie::LoadVariation load_pattern() const override { return {.block = {{0, 0}}, .x = {}}; }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.phi(x, out); }
    void variation(const lie::State& x, lie::Rows& out) const override { top.variation(x, out); }
    void nu(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.nu(x, out); }
    void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.gamma(x, out); }
    bool internal_states_are_history() const override { return has_history; }

    lie::State start() const { return tests::tilted_top(*this, top.s_bar); }

private:
    const tests::SpinningTop top;
    const double c;
    const bool has_history;
    const double preload;
};

const std::vector<std::string> names = {"rA-rattle", "rA-rattle-4", "rA-rattle-6", "rA-rattle-8"};
const lie::Settings tight{.tolerance = 1e-14, .max_iterations = 60};

Eigen::VectorXd values(const lie::State& x)
{
    Eigen::VectorXd q(21);
    const lie::Motion& body = x.body[0];
    q << body.r, Eigen::Map<const Eigen::VectorXd>(body.A.data(), 9), body.rdot, body.omega_bar, x.lambda;
    return q;
}

}  // namespace

TEST_CASE("rattle and its compositions return to their start, with dampers as well", "[lie][rattle]")
{
    for (const double c : {0., 0.1, 2.}) {
        const DampedTop top(c);
        for (const std::string& name : names) {
            const auto integrator = lie::scheme(name).make(top, tight);
            const lie::State start = top.start();
            lie::State x = start;
            constexpr int steps = 20;
            for (int n = 0; n < steps; ++n) integrator->step(x, 5e-3);
            CHECK((values(x) - values(start)).norm() > 0.1);
            for (int n = 0; n < steps; ++n) integrator->step(x, -5e-3);
            INFO(name << ", c = " << c);
            // Damping in one direction is growth in the other.
            CHECK((values(x) - values(start)).head(18).norm() < (c > 1 ? 1e-9 : 1e-11));
        }
    }
}

TEST_CASE("rattle, its compositions and its extrapolations have their order with dampers (long)",
          "[lie][order][rattle]")
{
    const DampedTop top(0.3);
    std::vector<std::string> all = names;
    all.insert(all.end(), {"rA-rattle-gbs-4", "rA-rattle-gbs-6", "rA-rattle-gbs-8"});
    for (const std::string& name : all) {
        const lie::Scheme& scheme = lie::scheme(name);
        const double h = scheme.order == 2           ? 1e-3
                         : scheme.order == 4         ? 5e-3
                         : scheme.order == 6         ? 1e-2
                         : name == "rA-rattle-gbs-8" ? 1e-2
                                                     : 2e-2;
        const auto at_end = [&](double step) {
            const auto integrator = scheme.make(top, tight);
            return values(
                lie::march(top.start(), *integrator, lie::TimeGrid::over(0.4, step, 0.4)).row.back());
        };
        const Eigen::VectorXd a = at_end(4 * h), b = at_end(2 * h), c = at_end(h);
        INFO(name);
        const auto order = [&](int first, int count) {
            return std::log2((a - b).segment(first, count).norm() / (b - c).segment(first, count).norm());
        };
        const double margin = scheme.order < 6 ? 0.1 : 0.2;
        CHECK(order(0, 18) == Approx(scheme.order).margin(margin));
        CHECK(order(18, 3) == Approx(scheme.order).margin(margin));
    }
}

TEST_CASE("the energy error of the compositions of rattle does not grow (long)", "[lie][invariants][rattle]")
{
    const tests::SpinningTop top;
    const lie::State start = top.start();
    for (const auto& [name, h] :
         {std::pair{"rA-rattle-4", 1e-2}, {"rA-rattle-6", 2e-2}, {"rA-rattle-8", 4e-2}}) {
        const auto integrator = lie::scheme(name).make(top, {.tolerance = 1e-13});
        lie::State x = start;
        double first = 0, all = 0;
        constexpr int steps = 4000;
        for (int n = 0; n < steps; ++n) {
            integrator->step(x, h);
            all = std::max(all, std::abs(lie::energy(top, x) - lie::energy(top, start)));
            if (n == steps / 8) first = all;
        }
        INFO(name << ": " << first << " J in the first eighth, " << all << " J in all");
        CHECK(all < 1.5 * first);
        CHECK(all < 1e-4);
    }
}

TEST_CASE("rattle takes dampers up to and beyond the stability limit of an explicit step", "[lie][rattle]")
{
    // h c/(2 J) of the smallest moment of inertia: 0.5 to 20
    constexpr double h = 1e-2;
    for (const double contraction : {0.5, 0.8, 0.95, 3., 20.}) {
        const DampedTop top(contraction * 2 * 0.05 / h);
        const auto integrator = lie::scheme("rA-rattle").make(top, {});
        lie::State x = top.start();
        INFO("contraction " << contraction);
        for (int n = 0; n < 20; ++n) REQUIRE_NOTHROW(integrator->step(x, h));
        CHECK(values(x).allFinite());
    }
}

TEST_CASE("rattle and its compositions take stiff springs under a large preload", "[lie][rattle]")
{
    // The sum of two forces of 1e6 N has a rounding error of 1e-10 N, which no iteration removes.
    for (const double c : {0.01, 0.3}) {
        const DampedTop top(c, false, 1e6);
        for (const std::string& name : names) {
            const auto integrator = lie::scheme(name).make(top, {});
            lie::State x = top.start();
            INFO(name << ", c = " << c);
            for (int n = 0; n < 20; ++n) REQUIRE_NOTHROW(integrator->step(x, 1e-3));
        }
    }
}

TEST_CASE("the compositions of rattle refuse loads with a history, which rattle takes", "[lie][rattle]")
{
    const DampedTop top(0.1, true);
    lie::State x = top.start();
    x.internal_state = {0.5};
    CHECK_NOTHROW(lie::scheme("rA-rattle").make(top, {})->step(x, 1e-3));
    for (const std::string& name : names) {
        if (name == "rA-rattle") continue;
        const auto integrator = lie::scheme(name).make(top, {});
        CHECK_THROWS_AS(integrator->step(x, 1e-3), lie::InvalidInput);
        CHECK_THROWS_WITH(integrator->step(x, 1e-3), Catch::Contains(name));
    }
}
