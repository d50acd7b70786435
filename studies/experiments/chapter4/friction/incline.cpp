// SPDX-License-Identifier: GPL-3.0-or-later
/// Sphere on an incline (Fang 2022, Sec. 4.4.4, Fig. 4.12). On a slope of 35 degrees the sphere starts with a
/// velocity up the slope: it rolls with slip, rolls up, rolls down, and slips down. On a slope of 2 degrees
/// it starts at rest and the rolling resistance keeps it there. y points up the slope.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

#include <numbers>

namespace hilda::studies::friction {

namespace {

constexpr double m = 5, R = 0.2, mu_s = 0.25, mu_k = 0.2, K_E = 1e5, eta_r = 0.3, g = 9.8, h = 1e-4;
constexpr double degree = std::numbers::pi / 180;

Series roll(const std::string& preset_name, double alpha, double v_0, double end, Frames* frames)
{
    contact::Scene scene;
    scene.gravity = {0, -g * std::sin(alpha), -g * std::cos(alpha)};
    const int ball = scene.add(solid_sphere(m, R), at({0, 0, R}, {0, v_0, 0}));
    const int slope = scene.add(contact::Inertia{}, {});
    const auto p = preset(preset_name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .eta_r = eta_r});
    scene.add("ball", ball, shape<contact::Sphere>(R), slope, shape<contact::Plane>(),
              std::make_shared<contact::GivenForce>(m * g * std::cos(alpha)), law(p));
    scene.check(h);
    return sample(
        scene, h, end, frames, {"t", "v_cm", "omega_x", "F_E", "T_E", "slips", "rolls"},
        [&](Series& s, const std::vector<contact::Motion>& body) {
            const contact::Wrench& w = scene.pair[0].wrench;
            const contact::Deflections& history = scene.pair[0].history.deflections;
            s.add({scene.t, body[ball].rdot.y(), (body[ball].A * body[ball].omega_bar).x(), w.F_E.y(),
                   w.T_roll_E.x(), history.slide.slipping ? 1. : 0., history.roll_i.slipping ? 1. : 0.});
        });
}

/// Sphere on a plane that tilts from the horizontal at `rate` [rad/s], with a stiff normal spring. Column
/// alpha is the angle of the plane [deg].
Series tilt(double rate, double end, Frames* frames)
{
    contact::Scene scene;
    const double k_n = 1e7;
    const int ball = scene.add(solid_sphere(m, R), at({0, 0, R - m * g / k_n}));
    const int slope = scene.add(contact::Inertia{}, {});
    const contact::FrictionParameters p{.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .eta_r = eta_r};
    scene.gravity = {0, 0, -g};
    scene.add("ball", ball, shape<contact::Sphere>(R), slope, shape<contact::Plane>(),
              std::make_shared<contact::Hooke>(contact::Hooke::with_restitution(k_n, 0.3)), law(p));
    scene.check(h);
    return sample(
        scene, h, end, frames, {"t", "alpha", "rolls"}, [&](Series& s, const std::vector<contact::Motion>&) {
            const double alpha = rate * scene.t;
            s.add({scene.t, alpha / degree, scene.pair[0].history.deflections.roll_i.slipping ? 1. : 0.});
            scene.gravity = {0, -g * std::sin(alpha), -g * std::cos(alpha)};
        });
}

std::vector<ExperimentRun> runs()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        all.push_back({.name = name, .compute = [name](Frames* frames) {
                           return roll(name, 35 * degree, 0.5, 0.3, frames);
                       }});
    for (const std::string& name : presets)
        all.push_back({.name = name + "-2deg",
                       .compute = [name](Frames* frames) { return roll(name, 2 * degree, 0, 1, frames); },
                       .check_only = true});
    all.push_back({.name = "slow-tilt",
                   .compute = [](Frames* frames) { return tilt(degree, 10, frames); },
                   .check_only = true});
    return all;
}

void checks(const Results& results, std::vector<Check>& out)
{
    const double alpha = 35 * degree, N = m * g * std::cos(alpha), J = 0.4 * m * R * R,
                 M = 2 * eta_r * R * mu_k * N;
    // slip on the way up, with v = v_0 - (g sin + mu_k g cos) t, omega = (mu_k N R - M) t / J until v = R
    // omega
    const double a_1 = g * std::sin(alpha) + mu_k * N / m, alpha_1 = (mu_k * N * R - M) / J;
    const double t_1 = 0.5 / (a_1 + R * alpha_1), v_1 = 0.5 - a_1 * t_1;
    // rolling up, decelerated by weight and rolling torque M
    const double a_2 = (m * g * std::sin(alpha) + M / R) / (m + J / (R * R)), t_2 = t_1 + v_1 / a_2;
    if (const Series* s = results.find("balanced")) {
        const double slip = s->first_time([&](size_t k) { return s->at(k, "slips") == 0; }, 0.01);
        const double top = s->first_time([&](size_t k) { return s->at(k, "v_cm") < 0; });
        double fastest = 0;
        for (size_t k = 0; k < s->rows() && s->at(k, 0) < top; ++k)
            fastest = std::max(fastest, std::abs(s->at(k, "omega_x")));
        const size_t n = s->rows() - 1;
        out.push_back({"end of slip, balanced [s]", slip, t_1, 0.01 * t_1, "rigid"});
        out.push_back({"time at the highest point, balanced [s]", top, t_2, 0.005 * t_2, "rigid"});
        out.push_back(
            {"largest omega on the way up, balanced [rad/s]", fastest, v_1 / R, 0.02 * v_1 / R, "rigid"});
        out.push_back({"acceleration while slipping down, balanced [m/s^2]",
                       (s->at(n, "v_cm") - s->at(n - 1, "v_cm")) / h, -g * std::sin(alpha) + mu_k * N / m,
                       1e-7, "rigid"});
        out.push_back({"angular acceleration while slipping down, balanced [rad/s^2]",
                       -std::abs(s->at(n, "omega_x") - s->at(n - 1, "omega_x")) / h, -(mu_k * N * R - M) / J,
                       1e-7, "rigid"});
        out.push_back({"kinetic rolling torque, balanced [N m]", std::abs(s->last("T_E")), M, 1e-9,
                       "2 eta_r R mu_k N"});
    }
    for (const std::string& name : presets) {
        const Series* s = results.find(name + "-2deg");
        if (s == nullptr) continue;
        const double F = m * g * std::sin(2 * degree);
        out.push_back(
            {"friction force on 2 degrees, " + name + " [N]", std::abs(s->last("F_E")), F, 1e-8, "m g sin"});
        out.push_back({"rolling torque on 2 degrees, " + name + " [N m]", std::abs(s->last("T_E")), F * R,
                       1e-8, "m g R sin"});
    }
    if (const Series* s = results.find("slow-tilt")) {
        const double limit = std::atan(2 * eta_r * mu_s) / degree;
        out.push_back({"angle at the start of rolling, slow tilt [deg]", s->first_time([&](size_t k) {
                           return s->at(k, "rolls") > 0 && s->at(k, "alpha") > 0.1;
                       }),
                       limit, 0.02, "arctan(2 eta_r mu_s)"});
    }
}

const bool incline = register_experiment({.name = "incline",
                                          .figure = "4.12",
                                          .what = "sphere pushed up a slope of 35 degrees",
                                          .runs = runs,
                                          .checks = checks,
                                          .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction
