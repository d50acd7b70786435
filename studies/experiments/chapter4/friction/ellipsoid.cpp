// SPDX-License-Identifier: GPL-3.0-or-later
/// Upright ellipsoid that tips over (Fang 2022, Sec. 4.4.6.1, Fig. 4.17). Without rolling resistance the
/// motion follows from the conservation of energy, which gives reference values.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"

#include <numbers>

namespace hilda::studies::friction {

namespace {

constexpr double m = 5, a = 0.2, c = 0.5, g = 9.8, pi = std::numbers::pi;

struct EllipsoidSetup {
    contact::FrictionParameters p;
    double v_0 = 0.3, omega_0 = 0, h = 1e-4, end = 3, k_n = 1e7;
    bool at_rest_height = true;  ///< start with the static deflection of the normal spring
};

Series simulate(const EllipsoidSetup& setup, Frames* frames)
{
    contact::Scene scene;
    scene.gravity = {0, 0, -g};
    const contact::Inertia inertia{
        m, lie::Vec3(m / 5 * (a * a + c * c), m / 5 * (a * a + c * c), m / 5 * 2 * a * a).asDiagonal()};
    contact::Motion start = at({0, 0, c - (setup.at_rest_height ? m * g / setup.k_n : 0)}, {0, setup.v_0, 0});
    start.omega_bar = {-setup.omega_0, 0, 0};
    const int body = scene.add(inertia, start), plane = scene.add(contact::Inertia{}, {});
    scene.add("ellipsoid", body, shape<contact::Ellipsoid>(lie::Vec3(a, a, c)), plane,
              shape<contact::Plane>(), std::make_shared<contact::Hooke>(setup.k_n, 0), law(setup.p));
    scene.check(setup.h);
    return sample(
        scene, setup.h, setup.end, frames, {"t", "y", "z", "tilt", "omega", "N", "F", "slips", "rolls"},
        [&](Series& s, const std::vector<contact::Motion>& b) {
            const lie::Vec3 axis = b[body].A.col(2);
            const contact::Scene::Pair& pair = scene.pair[0];
            const contact::Deflections& history = pair.history.deflections;
            s.add({scene.t, b[body].r.y(), b[body].r.z(), std::atan2(axis.y(), axis.z()) * 180 / pi,
                   -(b[body].A * b[body].omega_bar).x(), std::max(0., pair.contact_state.N),
                   pair.wrench.F.y(), history.slide.slipping ? 1. : 0., history.roll_i.slipping ? 1. : 0.});
        });
}

EllipsoidSetup falling_setup(const std::string& name)
{
    return {.p = preset(name, {.mu_s = 0.25, .mu_k = 0.2, .K_E = 1e5, .eta_r = 0.2})};
}

/// No rolling resistance, and friction large enough to prevent slip
EllipsoidSetup rolling_setup(double K_E, double h)
{
    return {.p = {.mu_s = 20, .mu_k = 20, .K_E = K_E}, .v_0 = 0.3, .omega_0 = 0.6, .h = h, .end = 0.85};
}

std::vector<ExperimentRun> runs()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        all.push_back({.name = name,
                       .compute = [name](Frames* frames) { return simulate(falling_setup(name), frames); }});
    all.push_back({.name = "no-resistance",
                   .compute = [](Frames* frames) { return simulate(rolling_setup(1e5, 1e-4), frames); }});
    all.push_back({.name = "no-resistance-stiff",
                   .compute = [](Frames* frames) { return simulate(rolling_setup(1e7, 5e-6), frames); },
                   .check_only = true});
    return all;
}

void checks(const Results& results, std::vector<Check>& out)
{
    const double t_90 = 0.788758, omega_90 = 7.818659, y_90 = 0.575328;
    for (const auto& [name, dt, domega, dy] : {std::tuple("no-resistance", 2e-4, 5e-3, 3e-4),
                                               std::tuple("no-resistance-stiff", 1e-5, 3e-4, 1e-6)}) {
        const Series* s = results.find(name);
        if (s == nullptr) continue;
        size_t k = 1;
        while (k < s->rows() && s->at(k, "tilt") < 90) ++k;
        const bool flat = k < s->rows();  // otherwise the results are NaN
        const double part =
            flat ? (90 - s->at(k - 1, "tilt")) / (s->at(k, "tilt") - s->at(k - 1, "tilt")) : std::nan("");
        const auto between = [&](const char* column) {
            const size_t end = flat ? k : k - 1;
            return s->at(k - 1, column) + part * (s->at(end, column) - s->at(k - 1, column));
        };
        const std::string suffix = std::string(", ") + name;
        out.push_back({"time at tilt 90 deg" + suffix + " [s]", between("t"), t_90, dt, "energy"});
        out.push_back({"omega at tilt 90 deg" + suffix + " [rad/s]", between("omega"), omega_90,
                       domega * omega_90, "energy"});
        out.push_back({"y at tilt 90 deg" + suffix + " [m]", between("y"), y_90, dy, "arc length"});
    }
    for (const std::string& name : presets) {
        const Series* s = results.find(name);
        if (s == nullptr) continue;
        const double reversal = s->first_time([&](size_t k) { return s->at(k, "omega") < 0; }, 0.5);
        out.push_back(
            {"reversal of the rotation, " + name + " [s]", reversal, 1.085, 0.035, "independent code"});
        out.push_back({"final tilt, " + name + " [deg]", s->last("tilt"), 90, 4, "within the static band"});
    }
}

const bool ellipsoid =
    register_experiment({.name = "ellipsoid",
                         .figure = "4.17",
                         .what = "upright ellipsoid that tips over and comes to rest on its side",
                         .runs = runs,
                         .checks = checks,
                         .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction
