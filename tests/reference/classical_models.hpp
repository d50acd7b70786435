// SPDX-License-Identifier: GPL-3.0-or-later
/// Models and order measurement for the schemes on Euler parameters and Euler angles.

#pragma once

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/reference/chains.hpp"
#include "tests/reference/reference_csv.hpp"

namespace hilda::tests {

/// Two spinning bars on ball joints. Reference solution: tests/data/x_n_pendulum_2_spin.csv
inline void two_spinning_bars(dae::Model& model, lie::State& x)
{
    ball_chain(2, model, x, [](lie::State& start) {
        start.body[0].rdot = Vec3(-0.5, -1, 0), start.body[0].omega_bar = Vec3(3, 0.5, -1);
        start.body[1].rdot = Vec3(-2, 0, 0), start.body[1].omega_bar = Vec3(-4, 1, 2);
    });
}

/// Double pendulum with initial velocities. Reference solution: tests/data/x_double_pendulum_moving.csv
inline void moving_double_pendulum(dae::Model& model, lie::State& x)
{
    DoublePendulum{.w = 0.1, .thetadot_1 = 1, .thetadot_2 = -2}.build(model, x);
}

/// States at the multiples of dt, without the initial state
inline std::vector<lie::State> run(const std::string& scheme, const lie::System& system, const lie::State& x,
                                   double h, double t_end, double dt,
                                   const lie::Settings& settings = {.tolerance = 1e-12})
{
    const auto integrator = lie::scheme(scheme).make(system, settings);
    std::vector<lie::State> rows = lie::march(x, *integrator, lie::TimeGrid::over(t_end, h, dt)).row;
    rows.erase(rows.begin());
    return rows;
}

/// Measured order of each part of a deviation, from two step sizes with the given ratio
inline Deviation order(const Deviation& coarse, const Deviation& fine, double ratio = 2)
{
    const auto of = [&](double a, double b) { return std::log(a / b) / std::log(ratio); };
    return {of(coarse.r, fine.r),         of(coarse.A, fine.A),
            of(coarse.rdot, fine.rdot),   of(coarse.omega_bar, fine.omega_bar),
            of(coarse.rddot, fine.rddot), of(coarse.omegadot_bar, fine.omegadot_bar)};
}

inline void check_order(const Deviation& measured, double declared, double margin = 0.1)
{
    INFO("declared " << declared << ", measured: " << measured);
    for (const double of :
         {measured.r, measured.A, measured.rdot, measured.omega_bar, measured.rddot, measured.omegadot_bar})
        CHECK(of == Approx(declared).margin(margin));
}

}  // namespace hilda::tests
