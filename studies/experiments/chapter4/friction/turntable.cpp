// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball rolling on a turntable: test of the spin correction of the contact frames. Not in the dissertation.
///
/// A ball that rolls without slip moves on a fixed circle with the angular velocity 2/7 Omega, independent of
/// its speed; Omega is the angular velocity of the table. The displacements of the contact point over ball
/// and table are compared in one frame, which is rotated by a fraction beta of the relative spin. Any beta
/// other than 1/2 makes the radius grow or shrink, with an error of first order in the step.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

#include <numbers>

namespace hilda::studies::friction {

namespace {

constexpr double m = 5, R = 0.2, g = 9.81, v = 0.5, Omega = 2 * std::numbers::pi, rate = 2 * Omega / 7;

Series orbit(double beta, double K_E, double h, Frames* frames)
{
    contact::Scene scene;
    const lie::Vec3 z = lie::Vec3::UnitZ(), r(v / rate, 0, R), axis(0.4, 0.3, 0), rdot(0, v, 0);
    contact::Motion ball = at(r, rdot), table = at(axis);
    ball.omega_bar =
        z.cross(rdot - Omega * z.cross(r - axis)) / R;  // rolling without slip relative to the moving table
    table.omega_bar = Omega * z;
    const int b = scene.add(solid_sphere(m, R), ball), t = scene.add(contact::Inertia{}, table);
    scene.add("turntable", b, shape<contact::Sphere>(R), t, shape<contact::Plane>(),
              std::make_shared<contact::GivenForce>(m * g),
              law({.mu_s = 5, .mu_k = 5, .K_E = K_E, .tracking = {.beta = beta}}));
    scene.check(h);
    double angle = 0, last = 0;
    return sample(
        scene, h, 10 * 2 * std::numbers::pi / rate, frames, {"t", "x", "y", "radius", "turns"},
        [&](Series& s, const std::vector<contact::Motion>& body) {
            const lie::Vec3& at = body[b].r;
            const double now = std::atan2(at.y(), at.x());
            angle += std::remainder(now - last, 2 * std::numbers::pi);
            last = now;
            s.add({scene.t, at.x(), at.y(), at.head<2>().norm() * rate / v, angle / (2 * std::numbers::pi)});
        });
}

std::vector<ExperimentRun> runs()
{
    return {{.name = "beta=0.5", .compute = [](Frames* frames) { return orbit(0.5, 1e5, 1e-3, frames); }},
            {.name = "beta=1", .compute = [](Frames* frames) { return orbit(1, 1e5, 1e-3, frames); }},
            {.name = "beta=0", .compute = [](Frames* frames) { return orbit(0, 1e5, 1e-3, frames); }},
            {.name = "beta=-1", .compute = [](Frames* frames) { return orbit(-1, 1e5, 1e-3, frames); }},
            {.name = "beta=1, h=1e-4",
             .compute = [](Frames* frames) { return orbit(1, 1e5, 1e-4, frames); },
             .check_only = true},
            {.name = "stiff",
             .compute = [](Frames* frames) { return orbit(0.5, 1e6, 1e-4, frames); },
             .check_only = true}};
}

void checks(const Results& results, std::vector<Check>& out)
{
    const auto radius = [&](const char* run, double required, double tolerance, const char* by) {
        if (const Series* s = results.find(run))
            out.push_back(
                {std::string("radius after 10 orbits, ") + run, s->last("radius"), required, tolerance, by});
    };
    radius("beta=0.5", 1, 2e-4, "exact");
    if (const Series* s = results.find("beta=0.5"))
        out.push_back({"number of orbits relative to the exact one, beta=0.5",
                       s->last("turns") / (s->last("t") * rate / (2 * std::numbers::pi)), 1, 1e-4,
                       "2/7 Omega"});
    radius("stiff", 1, 1e-5, "exact");
    radius("beta=1", 1.153, 2e-3, "independent code");
    radius("beta=1, h=1e-4", 1.014, 2e-3, "independent code");
    radius("beta=0", 0.870, 2e-3, "independent code");
    // large tolerance: the radius depends on the start
    radius("beta=-1", 0.667, 2e-2, "independent code");
}

const bool turntable = register_experiment(
    {.name = "turntable",
     .figure = "",
     .what = "ball on a turntable, ten orbits: the radius is constant only for beta = 0.5",
     .runs = runs,
     .checks = checks,
     .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction
