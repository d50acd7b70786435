// SPDX-License-Identifier: GPL-3.0-or-later
/// Upright ellipsoid that tips over (Fang 2022, Sec. 4.4.6.1, Fig. 4.17). Without rolling resistance the
/// motion follows from the conservation of energy, which gives reference values.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/ellipsoid.hpp"

#include <numbers>

namespace hilda::studies::friction::ellipsoid_runs {

namespace {

constexpr double m = 5, a = 0.2, c = 0.5, g = 9.8, pi = std::numbers::pi;

BodyOnPlane tip(const contact::FrictionParameters& p, double omega_0 = 0, double end = 3, double h = 1e-4)
{
    constexpr double k_n = 1e7, I_a = m / 5 * (a * a + c * c), I_c = m / 5 * 2 * a * a;
    contact::Motion start =
        at({0, 0, c - m * g / k_n}, {0, 0.3, 0});  // static deflection of the normal spring
    start.omega_bar = {-omega_0, 0, 0};
    return {.name = "ellipsoid",
            .inertia = {m, lie::Vec3(I_a, I_a, I_c).asDiagonal()},
            .start = start,
            .shape = shape<contact::Ellipsoid>(lie::Vec3(a, a, c)),
            .normal = std::make_shared<contact::Hooke>(k_n, 0),
            .friction = p,
            .h = h,
            .end = end,
            .columns = {"t", "y", "z", "tilt", "omega", "N", "F", "slips", "rolls"},
            .record = [](Curve& curve, const Node& n) {
                const lie::Vec3 axis = n.body.A.col(2);
                curve.add({n.scene.t, n.body.r.y(), n.body.r.z(), std::atan2(axis.y(), axis.z()) * 180 / pi,
                           -n.omega.x(), std::max(0., n.pair.contact_state.N), n.wrench.F.y(),
                           n.springs.slide.slipping ? 1. : 0., n.springs.roll_i.slipping ? 1. : 0.});
            }};
}

BodyOnPlane falling(const std::string& name)
{
    return tip(preset(name, {.mu_s = 0.25, .mu_k = 0.2, .K_E = 1e5, .eta_r = 0.2}));
}

/// No rolling resistance, and friction large enough to prevent slip
BodyOnPlane rolling(double K_E, double h) { return tip({.mu_s = 20, .mu_k = 20, .K_E = K_E}, 0.6, 0.85, h); }

/// A quantity when the axis is horizontal, by linear interpolation; NaN if it does not become horizontal
Measure at_tilt_90(const std::string& column)
{
    return [=](const Curve& s) {
        size_t k = 1;
        while (k < s.rows() && s.at(k, "tilt") < 90) ++k;
        if (k >= s.rows()) return std::nan("");
        const double part = (90 - s.at(k - 1, "tilt")) / (s.at(k, "tilt") - s.at(k - 1, "tilt"));
        return s.at(k - 1, column) + part * (s.at(k, column) - s.at(k - 1, column));
    };
}

std::vector<Expected> expected()
{
    const double t_90 = 0.788758, omega_90 = 7.818659, y_90 = 0.575328;
    std::vector<Expected> all;
    for (const auto& [run, dt, domega, dy] :
         {std::tuple<std::string, double, double, double>("no-resistance", 2e-4, 5e-3, 3e-4),
          {"no-resistance-stiff", 1e-5, 3e-4, 1e-6}}) {
        all.push_back({run, "time at tilt 90 deg, " + run + " [s]", at_tilt_90("t"), t_90, dt, "energy"});
        all.push_back({run, "omega at tilt 90 deg, " + run + " [rad/s]", at_tilt_90("omega"), omega_90,
                       domega * omega_90, "energy"});
        all.push_back({run, "y at tilt 90 deg, " + run + " [m]", at_tilt_90("y"), y_90, dy, "arc length"});
    }
    for (const std::string& name : presets) {
        all.push_back({name, "reversal of the rotation, " + name + " [s]",
                       first(
                           "omega", [](double omega) { return omega < 0; }, 0.5),
                       1.085, 0.035, "independent code"});
        all.push_back(
            {name, "final tilt, " + name + " [deg]", last("tilt"), 90, 4, "within the static band"});
    }
    return all;
}

const bool ellipsoid =
    register_experiment({.name = "ellipsoid",
                         .figure = "4.17",
                         .what = "upright ellipsoid that tips over and comes to rest on its side",
                         .runs = {{.name = "dissertation",
                                   .setup = [] { return falling("dissertation"); },
                                   .snapshots = {0, 0.75, 0.9, 1.8, 2.1, 3}},
                                  {"balanced", [] { return falling("balanced"); }},
                                  {"no-resistance", [] { return rolling(1e5, 1e-4); }},
                                  {"no-resistance-stiff", [] { return rolling(1e7, 5e-6); }, true}},
                         .expected = expected(),
                         .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction::ellipsoid_runs
