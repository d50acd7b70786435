// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/incline.hpp"

#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

#include <algorithm>

namespace hilda::studies {

contact::Scene scene(const Incline& incline)
{
    constexpr double m = 5, g = 9.8, R = Incline::R;
    contact::FrictionParameters p{.mu_s = Incline::mu_s,
                                  .mu_k = Incline::mu_k,
                                  .K_E = 1e5,
                                  .zeta = incline.zeta,
                                  .eta_r = incline.eta_r};
    if (incline.dissertation) p = p.as_in_dissertation();

    contact::Scene scene;
    scene.gravity = {-g * std::sin(incline.alpha), 0, -g * std::cos(incline.alpha)};
    contact::Motion start;
    start.r = {0, 0, R};
    start.rdot = {incline.v_0, 0, 0};
    scene.add({m, 0.4 * m * R * R * lie::Mat3::Identity()}, start);
    scene.add(contact::Inertia{}, contact::Motion{});
    scene.add("sphere-incline", 0, {std::make_shared<contact::Sphere>(R)}, 1,
              {std::make_shared<contact::Plane>()},
              std::make_shared<contact::GivenForce>(m * g * std::cos(incline.alpha)),
              contact::friction_law("slide-roll-spin").make(p));
    return scene;
}

InclineState state_of(const contact::Scene& scene)
{
    const contact::Deflections& history = scene.pair[0].history.deflections;
    if (history.slide.slipping)
        return history.roll_i.slipping ? InclineState::rolling_with_slip : InclineState::slip;
    return history.roll_i.slipping ? InclineState::rolling : InclineState::rest;
}

double rest_limit(double eta_r) { return std::atan(std::min(2 * eta_r * Incline::mu_k, Incline::mu_s)); }

double rolling_limit(double eta_r) { return std::atan(3.5 * Incline::mu_s - 5 * eta_r * Incline::mu_k); }

}  // namespace hilda::studies
