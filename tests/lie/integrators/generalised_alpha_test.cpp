// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-genalpha: its own accelerations a_n.

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/sprung_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

TEST_CASE(
    "a_n of generalised-alpha is a second-order approximation of the shifted acceleration from the start on",
    "[lie][order]")
{
    // A free body: (r̈, ω̄̇) at t_n + (α_m - α_f) h is that of a run of high order to this time.
    const tests::SpinningTop top(true);
    const lie::State start = top.start();
    const double rho = GENERATE(0., 0.5, 0.9), shift = (2 * rho - 1) / (rho + 1) - rho / (rho + 1);
    const auto error = [&](double h) {
        const auto integrator =
            lie::scheme("rA-genalpha").make(top, {.tolerance = 1e-14, .rho_infinity = rho});
        lie::State x = start;
        integrator->step(x, h);
        lie::State exact = start;
        const auto fine = lie::scheme("rA-rkmk-4").make(top, {});
        constexpr int steps = 20;
        for (int k = 0; k < steps; ++k) fine->step(exact, (1 + shift) * h / steps);
        return (x.history.tail<3>() - exact.body[0].omegadot_bar).norm();
    };
    const double coarse = error(2e-3), fine = error(1e-3);
    INFO("rho " << rho << ": errors " << coarse << ", " << fine);
    CHECK(std::log2(coarse / fine) > 1.7);
}

TEST_CASE("generalised-alpha converges with stiff loads, with few factorisations", "[lie][newton]")
{
    const tests::SpinningTop joint;
    const auto reference = lie::scheme("rA-dop853").make(joint, {});
    const lie::State exact =
        lie::march(joint.start(), *reference, lie::TimeGrid::over(0.5, 5e-3, 0.5)).row.back();
    for (const double stiffness : {1e4, 1e6, 1e8, 1e10})
        for (const double damping : {0., 1e3, 1e5})
            for (const double h : {1e-2, 1e-3}) {
                if (h > 1e-3 && stiffness > 1e7) continue;  // the spring turns by 0.06 rad in a step
                const tests::SprungTop top(stiffness, damping);
                const auto integrator = lie::scheme("rA-genalpha").make(top, {.rho_infinity = 0.2});
                const lie::State end =
                    lie::march(top.start(), *integrator, lie::TimeGrid::over(0.5, h, 0.5)).row.back();
                const lie::Statistics s = integrator->statistics();
                const double error = (end.body[0].r - exact.body[0].r).norm();
                INFO("k " << stiffness << ", c " << damping << ", h " << h << ": error " << error << ", "
                          << s.refactorizations << " factorisations in " << s.steps << " steps");
                CHECK(error < 60 * h * h + 300 / stiffness);
                if (h == 1e-3 && stiffness < 1e9 && damping < 1e4) CHECK(s.refactorizations < s.steps);
            }
}
