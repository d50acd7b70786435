// SPDX-License-Identifier: GPL-3.0-or-later
/// Sphere on an incline (Fang 2022, Sec. 4.4.4, Fig. 4.12). On a slope of 35 degrees the sphere starts with a
/// velocity up the slope: it rolls with slip, rolls up, rolls down, and slips down. On a slope of 2 degrees
/// it starts at rest and the rolling resistance keeps it there. y points up the slope.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/sphere.hpp"

#include <numbers>

namespace hilda::studies::friction::incline_runs {

namespace {

constexpr double m = 5, R = 0.2, mu_s = 0.25, mu_k = 0.2, K_E = 1e5, eta_r = 0.3, g = 9.8, h = 1e-4;
constexpr double degree = std::numbers::pi / 180;

BodyOnPlane sphere(double alpha, const std::string& preset_name, double end)
{
    return {.name = "ball",
            .inertia = solid_sphere(m, R),
            .start = at({0, 0, R}),
            .shape = shape<contact::Sphere>(R),
            .gravity = {0, -g * std::sin(alpha), -g * std::cos(alpha)},
            .normal = given_force(m * g * std::cos(alpha)),
            .friction = preset(preset_name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .eta_r = eta_r}),
            .h = h,
            .end = end};
}

BodyOnPlane roll(const std::string& preset_name, double alpha, double v_0, double end)
{
    BodyOnPlane setup = sphere(alpha, preset_name, end);
    setup.start.rdot.y() = v_0;
    setup.columns = {"t", "v_cm", "omega_x", "F_E", "T_E", "slips", "rolls"};
    setup.record = [](Curve& c, const Node& n) {
        c.add({n.scene.t, n.body.rdot.y(), n.omega.x(), n.wrench.F_E.y(), n.wrench.T_roll_E.x(),
               n.springs.slide.slipping ? 1. : 0., n.springs.roll_i.slipping ? 1. : 0.});
    };
    return setup;
}

/// Sphere on a plane that tilts from the horizontal at `rate` [rad/s], with a stiff normal spring. Column
/// alpha is the angle of the plane [deg].
BodyOnPlane tilt(double rate, double end)
{
    constexpr double k_n = 1e7;
    BodyOnPlane setup = sphere(0, "balanced", end);
    setup.start = at({0, 0, R - m * g / k_n});
    setup.normal = std::make_shared<contact::Hooke>(contact::Hooke::with_restitution(k_n, 0.3));
    setup.columns = {"t", "alpha", "rolls"};
    setup.record = [=](Curve& c, const Node& n) {
        const double alpha = rate * n.scene.t;
        c.add({n.scene.t, alpha / degree, n.springs.roll_i.slipping ? 1. : 0.});
        n.scene.gravity = {0, -g * std::sin(alpha), -g * std::cos(alpha)};
    };
    return setup;
}

std::vector<ExperimentRun> runs()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        all.push_back({name, [=] { return roll(name, 35 * degree, 0.5, 0.3); }});
    all.front().snapshots = {0.004, 0.05, 0.09, 0.2};  // Fig. 4.12 b-e, preset dissertation
    for (const std::string& name : presets)
        all.push_back({name + "-2deg", [=] { return roll(name, 2 * degree, 0, 1); }, true});
    all.push_back({"slow-tilt", [] { return tilt(degree, 10); }, true});
    return all;
}

/// Time of the highest point [s]
double top(const Curve& c)
{
    return c.first_time([&](size_t k) { return c.at(k, "v_cm") < 0; });
}

std::vector<Expected> expected()
{
    const double alpha = 35 * degree, N = m * g * std::cos(alpha), J = 0.4 * m * R * R,
                 M = 2 * eta_r * R * mu_k * N;
    // slip on the way up, with v = v_0 - (g sin + mu_k g cos) t, omega = (mu_k N R - M) t / J until v = R
    // omega
    const double a_1 = g * std::sin(alpha) + mu_k * N / m, alpha_1 = (mu_k * N * R - M) / J;
    const double t_1 = 0.5 / (a_1 + R * alpha_1), v_1 = 0.5 - a_1 * t_1;
    // rolling up, decelerated by weight and rolling torque M
    const double a_2 = (m * g * std::sin(alpha) + M / R) / (m + J / (R * R)), t_2 = t_1 + v_1 / a_2;
    const auto size = [](const std::string& column) {
        return [=](const Curve& c) { return std::abs(c.last(column)); };
    };
    std::vector<Expected> all = {
        {"balanced", "end of slip, balanced [s]",
         first(
             "slips", [](double slips) { return slips == 0; }, 0.01),
         t_1, 0.01 * t_1, "rigid"},
        {"balanced", "time at the highest point, balanced [s]", top, t_2, 0.005 * t_2, "rigid"},
        {"balanced", "largest omega on the way up, balanced [rad/s]",
         [](const Curve& c) {
             double fastest = 0;
             const double end = top(c);
             for (size_t k = 0; k < c.rows() && c.t(k) < end; ++k)
                 fastest = std::max(fastest, std::abs(c.at(k, "omega_x")));
             return fastest;
         },
         v_1 / R, 0.02 * v_1 / R, "rigid"},
        {"balanced", "acceleration while slipping down, balanced [m/s^2]", last_rate("v_cm", h),
         -g * std::sin(alpha) + mu_k * N / m, 1e-7, "rigid"},
        {"balanced", "angular acceleration while slipping down, balanced [rad/s^2]",
         [](const Curve& c) { return -std::abs(last_rate("omega_x", h)(c)); }, -(mu_k * N * R - M) / J, 1e-7,
         "rigid"},
        {"balanced", "kinetic rolling torque, balanced [N m]", size("T_E"), M, 1e-9, "2 eta_r R mu_k N"}};
    const double F = m * g * std::sin(2 * degree);
    for (const std::string& name : presets) {
        all.push_back({name + "-2deg", "friction force on 2 degrees, " + name + " [N]", size("F_E"), F, 1e-8,
                       "m g sin"});
        all.push_back({name + "-2deg", "rolling torque on 2 degrees, " + name + " [N m]", size("T_E"), F * R,
                       1e-8, "m g R sin"});
    }
    all.push_back({"slow-tilt", "angle at the start of rolling, slow tilt [deg]",
                   [](const Curve& c) {
                       return c.first_time(
                           [&](size_t k) { return c.at(k, "rolls") > 0 && c.at(k, "alpha") > 0.1; });
                   },
                   std::atan(2 * eta_r * mu_s) / degree, 0.02, "arctan(2 eta_r mu_s)"});
    return all;
}

const bool incline = register_experiment({.name = "incline",
                                          .figure = "4.12",
                                          .what = "sphere pushed up a slope of 35 degrees",
                                          .runs = runs(),
                                          .expected = expected(),
                                          .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction::incline_runs
