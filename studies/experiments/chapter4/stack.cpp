// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/stack.hpp"

#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

namespace hilda::studies {

namespace {

using contact::Inertia;
using contact::Motion;
using lie::Mat3;

constexpr double m = 1;     // mass of a lower sphere [kg]
constexpr double g = 9.81;  // [m/s²]
constexpr double restitution = 0.4;
constexpr double collapse_drop = 0.1;      // descent of the upper sphere that counts as collapse, over R
constexpr double time_without_slip = 0.2;  // after this time the stack is stable [s]

Inertia ball(double mass) { return {mass, 0.4 * mass * Stack::R * Stack::R * Mat3::Identity()}; }

Motion at(double x, double z)
{
    Motion motion;
    motion.r = {x, 0, z};
    return motion;
}

/// Whether a friction spring slips or the surfaces are separated
bool slips_or_separated(const contact::ContactHistory& history)
{
    const contact::Deflections& h = history.deflections;
    return !history.touching || h.slide.slipping || h.roll_i.slipping || h.roll_j.slipping || h.spin.slipping;
}

}  // namespace

contact::Scene scene(const Stack& stack)
{
    constexpr double R = Stack::R;
    const double E_star = contact::effective_modulus(2e6, 0.3, 2e6, 0.3);
    const double overlap = std::pow(m * g / (4. / 3 * E_star * std::sqrt(R)), 2. / 3);  // Eq. 2.42
    const double x = (1 + stack.gap / 2) * R, z = R - overlap;

    contact::FrictionParameters p{.mu_s = 0.25, .mu_k = 0.2, .K_E = 1e5, .eta_r = stack.eta_r};
    if (stack.dissertation) p = p.as_in_dissertation();
    const auto friction = contact::friction_law("slide-roll-spin").make(p);
    const auto between =
        std::make_shared<contact::Hertz>(contact::Hertz::of_free_oscillation(E_star, restitution));
    const auto below =
        std::make_shared<contact::Hertz>(contact::Hertz::of_free_oscillation(E_star, restitution, m / 2));
    const contact::Shape sphere{std::make_shared<contact::Sphere>(R)},
        plane{std::make_shared<contact::Plane>()};

    contact::Scene scene;
    scene.gravity = {0, 0, -g};
    scene.add(ball(m), at(-x, z));
    scene.add(ball(m), at(x, z));
    scene.add(ball(stack.top), at(0, z + std::sqrt(4 * R * R - x * x)));
    scene.add(Inertia{}, Motion{});
    using namespace stacked;
    scene.add("top-left", top, sphere, left, sphere, between, friction);
    scene.add("top-right", top, sphere, right, sphere, between, friction);
    scene.add("left-ground", left, sphere, ground, plane, below, friction);
    scene.add("right-ground", right, sphere, ground, plane, below, friction);
    return scene;
}

StackOutcome run_until_decided(contact::Scene& scene, double h, double end)
{
    const double lowest = scene.body[stacked::top].r.z() - collapse_drop * Stack::R;
    StackOutcome outcome;
    for (double last_slip = scene.t; scene.t < end && outcome.state == StackOutcome::undecided;) {
        scene.step(h);
        for (const contact::Scene::Pair& pair : scene.pair)
            if (slips_or_separated(pair.history)) last_slip = scene.t;
        if (scene.body[stacked::top].r.z() < lowest)
            outcome.state = StackOutcome::collapses;
        else if (scene.t - last_slip > time_without_slip)
            outcome.state = StackOutcome::stable;
    }
    const contact::Deflections& history = scene.pair[stacked::right_ground].history.deflections;
    outcome.t = scene.t;
    outcome.rolls = history.roll_i.slipping;
    outcome.slides = history.slide.slipping;
    return outcome;
}

}  // namespace hilda::studies
