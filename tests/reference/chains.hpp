// SPDX-License-Identifier: GPL-3.0-or-later
/// Double pendulum and chains of bars on ball joints, as models and in minimal coordinates.

#pragma once

#include "dae/joints.hpp"
#include "dae/start.hpp"
#include "reference/motions/closed_form.hpp"
#include "tests/support/mechanisms.hpp"

namespace hilda::tests {

/// Double pendulum of Fang (2022), Table 3.2, with the width w of the square bars [m] and the initial angular
/// velocities [rad/s]
struct DoublePendulum {
    double w = 0.1, thetadot_1 = 0, thetadot_2 = 0;

    double mass(double length) const { return 7800 * w * w * length; }
    Vec3 J_bar(double length) const
    {
        const double transverse = mass(length) * (w * w + length * length) / 12;
        return {mass(length) * w * w / 6, transverse, transverse};
    }

    void build(dae::Model& model, lie::State& x) const
    {
        const Vec3 X = Vec3::UnitX(), O = Vec3::Zero();
        add_body(model, x, "bar_1", mass(4), J_bar(4), {0, 2, 0}, matrix({0, 0, 1}, {1, 0, 0}, {0, 1, 0}),
                 {0, 0, 2 * thetadot_1}, {0, 0, thetadot_1});
        add_body(model, x, "bar_2", mass(2), J_bar(2), {0, 4, -1}, matrix({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}),
                 {0, thetadot_2, 4 * thetadot_1}, {0, 0, thetadot_2});
        model.constrain("first", dae::revolute(ground, O, X, 0, {-2, 0, 0}, Vec3::UnitZ()));
        model.constrain("second", dae::revolute(0, {2, 0, 0}, Vec3::UnitZ(), 1, {-1, 0, 0}, Vec3::UnitZ()));
        dae::start(model, x);
    }

    /// The same double pendulum in the two angles
    reference::PlanarChain angles() const
    {
        constexpr double right_angle = 1.57079632679489661923;
        return {
            .bar = {
                {.length = 4, .m = mass(4), .J = J_bar(4).z(), .theta = right_angle, .thetadot = thetadot_1},
                {.length = 2, .m = mass(2), .J = J_bar(2).z(), .theta = 0, .thetadot = thetadot_2}}};
    }
};

inline const Vec3 slanting(0.7032947922, 6.717281251500001, 7.1147458602);

/// Chain of N bars of 2 m, hanging along -z on ball joints, under the gravity `slanting`. `start` sets the
/// initial velocities.
template <class Start>
void ball_chain(int N, dae::Model& model, lie::State& x, const Start& start)
{
    model.gravity = slanting;
    for (int b = 0; b < N; ++b) {
        add_body(model, x, "bar_" + std::to_string(b + 1), 39, {0.01625, 13.008125, 13.008125},
                 {0, 0, -2.0 * b - 1}, matrix({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}));
        model.constrain("ball_" + std::to_string(b + 1),
                        dae::spherical(b - 1, {b == 0 ? 0.0 : 1.0, 0, 0}, b, {-1, 0, 0}));
    }
    start(x);
    dae::start(model, x);
}

}  // namespace hilda::tests
