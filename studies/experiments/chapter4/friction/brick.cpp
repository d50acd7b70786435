// SPDX-License-Identifier: GPL-3.0-or-later
/// Brick on an incline (Fang 2022, Sec. 4.4.2). Fig. 4.6: a slope on which the brick sticks, with and without
/// dashpot. Fig. 4.7: slopes of arctan mu_k, arctan mu_s and 0.25 rad. The brick does not rotate; x points
/// down the slope.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/foot.hpp"

namespace hilda::studies::friction::brick_runs {

namespace {

constexpr double m = 1, mu_s = 0.25, mu_k = 0.2, K_E = 1e5, g = 9.8, h = 1e-4;

BodyOnPlane slide(double alpha, double zeta, double end)
{
    return {.name = "brick",
            .inertia = {.m = m},
            .shape = shape<contact::Foot>(),
            .gravity = {g * std::sin(alpha), 0, -g * std::cos(alpha)},
            .normal = given_force(m * g * std::cos(alpha)),
            .friction = {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .zeta = zeta, .capped = false},
            .h = h,
            .end = end,
            .columns = {"t", "x", "v", "Ef", "Df", "S", "dS", "slips"},
            .record = [](Curve& c, const Node& n) {
                const double Ef = -n.wrench.F_E.x();
                c.add({n.scene.t, n.body.r.x(), n.body.rdot.x(), Ef, -n.wrench.F.x() - Ef, Ef / K_E,
                       -n.pair.contact_state.slip.ds.x(), n.springs.slide.slipping ? 1. : 0.});
            }};
}

const double rest = m * g * std::sin(0.18) / K_E;

const bool brick = register_experiment(
    {.name = "brick",
     .figure = "4.6",
     .what = "brick on a slope of 0.18 rad, with and without dashpot",
     .runs = {{"damped", [] { return slide(0.18, 1, 0.1); }},
              {"undamped", [] { return slide(0.18, 0, 0.1); }}},
     .expected = {{"damped", "x at rest, damped [m]", last("x"), rest, 1e-9 * rest, "m g sin(alpha) / K_E"},
                  {"damped", "number of steps with slip, damped", count("slips"), 0, 0, "sticks"}}});

// On the slope of arctan mu_s the required friction equals the static bound; the spring force approaches it
// from below.
const bool brick_angles = register_experiment(
    {.name = "brick-angles",
     .figure = "4.7",
     .what = "brick on slopes of arctan mu_k, arctan mu_s and 0.25 rad",
     .runs = {{"atan_muk", [] { return slide(std::atan(mu_k), 1, 0.04); }},
              {"atan_mus", [] { return slide(std::atan(mu_s), 1, 0.04); }},
              {"0.25", [] { return slide(0.25, 1, 0.04); }}},
     .expected = {{"0.25", "acceleration at 0.25 rad [m/s^2]", last_rate("v", h),
                   g*(std::sin(0.25) - mu_k * std::cos(0.25)), 1e-9, "g (sin - mu_k cos)"},
                  {"0.25", "start of slip at 0.25 rad [s]",
                   first("slips", [](double slips) { return slips > 0; }), 0.0185, 1e-12, "published run"},
                  {"atan_mus", "number of steps with slip at arctan mu_s", count("slips"), 0, 0, "sticks"}}});

}  // namespace

}  // namespace hilda::studies::friction::brick_runs
