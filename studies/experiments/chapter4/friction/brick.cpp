// SPDX-License-Identifier: GPL-3.0-or-later
/// Brick on an incline (Fang 2022, Sec. 4.4.2). Fig. 4.6: a slope on which the brick sticks, with and without
/// dashpot. Fig. 4.7: slopes of arctan mu_k, arctan mu_s and 0.25 rad. The brick does not rotate; x points
/// down the slope.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"

namespace hilda::studies::friction {

namespace {

constexpr double m = 1, mu_s = 0.25, mu_k = 0.2, K_E = 1e5, g = 9.8, h = 1e-4;

Series slide(double alpha, double zeta, double end, Frames* frames)
{
    contact::Scene scene;
    scene.gravity = {g * std::sin(alpha), 0, -g * std::cos(alpha)};
    const int brick = scene.add({.m = m}, {}), slope = scene.add(contact::Inertia{}, {});
    const contact::FrictionParameters p{
        .mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .zeta = zeta, .capped = false};
    scene.add("brick", brick, shape<contact::Foot>(), slope, shape<contact::Plane>(),
              std::make_shared<contact::GivenForce>(m * g * std::cos(alpha)), law(p));
    scene.check(h);
    return sample(
        scene, h, end, frames, {"t", "x", "v", "Ef", "Df", "S", "dS", "slips"},
        [&](Series& s, const std::vector<contact::Motion>& body) {
            const contact::Scene::Pair& pair = scene.pair[0];
            const double Ef = -pair.wrench.F_E.x();
            s.add({scene.t, body[brick].r.x(), body[brick].rdot.x(), Ef, -pair.wrench.F.x() - Ef, Ef / K_E,
                   -pair.contact_state.slip.ds.x(), pair.history.deflections.slide.slipping ? 1. : 0.});
        });
}

std::vector<ExperimentRun> dashpot()
{
    return {{.name = "damped", .compute = [](Frames* frames) { return slide(0.18, 1, 0.1, frames); }},
            {.name = "undamped", .compute = [](Frames* frames) { return slide(0.18, 0, 0.1, frames); }}};
}

void check_dashpot(const Results& runs, std::vector<Check>& out)
{
    const Series* s = runs.find("damped");
    if (s == nullptr) return;
    const double rest = m * g * std::sin(0.18) / K_E;
    out.push_back({"x at rest, damped [m]", s->last("x"), rest, 1e-9 * rest, "m g sin(alpha) / K_E"});
    const auto slips = s->all("slips");
    out.push_back({"number of steps with slip, damped",
                   static_cast<double>(std::count(slips.begin(), slips.end(), 1.)), 0, 0, "sticks"});
}

const bool brick = register_experiment({.name = "brick",
                                        .figure = "4.6",
                                        .what = "brick on a slope of 0.18 rad, with and without dashpot",
                                        .runs = dashpot,
                                        .checks = check_dashpot});

std::vector<ExperimentRun> angles()
{
    return {{.name = "atan_muk",
             .compute = [](Frames* frames) { return slide(std::atan(mu_k), 1, 0.04, frames); }},
            {.name = "atan_mus",
             .compute = [](Frames* frames) { return slide(std::atan(mu_s), 1, 0.04, frames); }},
            {.name = "0.25", .compute = [](Frames* frames) { return slide(0.25, 1, 0.04, frames); }}};
}

void check_angles(const Results& runs, std::vector<Check>& out)
{
    if (const Series* s = runs.find("0.25")) {
        const size_t n = s->rows() - 1;
        out.push_back({"acceleration at 0.25 rad [m/s^2]", (s->at(n, "v") - s->at(n - 1, "v")) / h,
                       g * (std::sin(0.25) - mu_k * std::cos(0.25)), 1e-9, "g (sin - mu_k cos)"});
        out.push_back({"start of slip at 0.25 rad [s]",
                       s->first_time([&](size_t k) { return s->at(k, "slips") > 0; }), 0.0185, 1e-12,
                       "published run"});
    }
    // On this slope the required friction equals the static bound; the spring force approaches it from below.
    if (const Series* s = runs.find("atan_mus")) {
        const auto slips = s->all("slips");
        out.push_back({"number of steps with slip at arctan mu_s",
                       static_cast<double>(std::count(slips.begin(), slips.end(), 1.)), 0, 0, "sticks"});
    }
}

const bool brick_angles =
    register_experiment({.name = "brick-angles",
                         .figure = "4.7",
                         .what = "brick on slopes of arctan mu_k, arctan mu_s and 0.25 rad",
                         .runs = angles,
                         .checks = check_angles});

}  // namespace

}  // namespace hilda::studies::friction
