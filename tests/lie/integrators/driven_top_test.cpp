// SPDX-License-Identifier: GPL-3.0-or-later
/// The orders of the schemes with loads that depend on velocities and time, and with a driven joint.

#include "tests/support/driven_top.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/lie/one_body_state.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using tests::motion;

TEST_CASE("the declared order holds for loads that depend on velocities and for a driven joint (long)",
          "[lie][order]")
{
    const tests::DrivenTop top;
    const lie::State start = top.start();
    for (const lie::Scheme& s : lie::schemes()) {
        if (s.adaptive || s.needs_tree) continue;  // of order in the tolerance; not for drivers
        const double h = s.name == "rA-radau-5" ? 1e-2
                         : s.order >= 8         ? 1.25e-2
                         : s.order > 2          ? 5e-3
                         : s.order_lambda > 1   ? 2e-4
                                                : 5e-5;
        const auto at = [&](double step) {
            const auto integrator = s.make(top, {.tolerance = 1e-13, .max_iterations = 30});
            return lie::march(start, *integrator, lie::TimeGrid::over(0.4, step, 0.4)).row.back();
        };
        const lie::State a = at(4 * h), b = at(2 * h), c = at(h);
        const double of_motion = std::log2((motion(a) - motion(b)).norm() / (motion(b) - motion(c)).norm()),
                     of_lambda = std::log2((a.lambda - b.lambda).norm() / (b.lambda - c.lambda).norm());
        INFO(s.name << " declares " << s.order << " and " << s.order_lambda << " for lambda, shows "
                    << of_motion << " and " << of_lambda);
        CHECK(of_motion == Approx(s.order).margin(0.15));
        CHECK(of_lambda == Approx(s.order_lambda).margin(0.25));
    }
}
