// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-genalpha: its own accelerations a_n.

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/support/spinning_top.hpp"

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
