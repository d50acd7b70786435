// SPDX-License-Identifier: GPL-3.0-or-later
// Steps in which the contact point moves far over a body: the Newton matrix of t_n does not suffice.
#include "contact/evolving/contact.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/torus.hpp"
#include "dae/start.hpp"
#include "tests/support/gravity.hpp"
#include "tests/support/watched_march.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::contact;
using lie::State;
using tests::g;
using tests::march;

namespace {

const char* const schemes[] = {"rA-half-1-momentum", "rA-half-1-kick", "rA-half-1"};

}  // namespace

TEST_CASE("a ball that turns by 0.8 rad per step rolls in a cylinder as with small steps (long)",
          "[contact][evolving]")
{
    constexpr double R = 1, r = 0.1, m = 1, v = 8, I = 0.4 * m * r * r;
    dae::Model model;
    model.gravity = {0, -g, 0};
    model.add({.name = "ball", .m = m, .J_bar = I * Mat3::Identity()});
    model.constrain("ball-cylinder", std::make_unique<EvolvingContact>(
                                         0, Shape{.surface = std::make_shared<Sphere>(r)}, dae::ground,
                                         Shape{.surface = std::make_shared<Cylinder>(R, true)},
                                         EvolvingContact::Friction::rolling));
    State x;
    x.body.resize(1);
    x.body[0].r.y() = -(R - r);
    x.body[0].rdot.x() = v;
    x.body[0].omega_bar.z() = -v / r;
    dae::start(model, x);
    const Vec3 right = march(model, x, "rA-rkmk-4", 0.5, 1e-3).body[0].r;
    for (const char* scheme : schemes) {
        const double far = (march(model, x, scheme, 0.5, 1e-2).body[0].r - right).norm(),
                     near = (march(model, x, scheme, 0.5, 5e-3).body[0].r - right).norm();
        INFO(scheme << ' ' << far << ' ' << near);
        CHECK(far < 0.1);
        CHECK(std::log2(far / near) > 0.8);
    }
}

TEST_CASE("a fast Euler disk rolls with steps of a millisecond (long)", "[contact][evolving]")
{
    // The centre is at rest. Thin ring: 4 g = R Ω² sin θ; the tube changes it slightly.
    constexpr double R = 0.0375, a = 0.003, m = 0.4;
    const double theta = 7 * M_PI / 180, Omega = std::sqrt(4 * g / (R * std::sin(theta)));
    CHECK(Omega == Approx(93).margin(1));
    dae::Model model;
    model.add({.name = "disk", .m = m, .J_bar = m * R * R * Vec3(0.25, 0.25, 0.5).asDiagonal()});
    model.constrain("disk-floor",
                    std::make_unique<EvolvingContact>(
                        0, Shape{.surface = std::make_shared<Torus>(R, a)}, dae::ground,
                        Shape{.surface = std::make_shared<Plane>()}, EvolvingContact::Friction::rolling));
    State x;
    x.body.resize(1);
    x.body[0].A = lie::exp(Vec3(theta, 0, 0));
    x.body[0].r.z() = R * std::sin(theta) + a;
    x.body[0].omega_bar = {0, Omega * std::sin(theta), 0};
    dae::start(model, x, {.fix_initial = true});
    const auto energy = [&](const State& s) {
        const auto& b = s.body[0];
        return 0.5 * m * b.rdot.squaredNorm() + 0.5 * b.omega_bar.dot(model.mass().J_bar[0] * b.omega_bar) +
               model.potential_energy(s);
    };
    const double start = energy(x);
    const Vec3 right = march(model, x, "rA-rkmk-4", 0.5, 2e-4).body[0].r;
    for (const char* scheme : schemes) {
        const State end = march(model, x, scheme, 0.5, 1e-3);
        INFO(scheme);
        CHECK(energy(end) == Approx(start).epsilon(2e-2));
        if (scheme != std::string("rA-half-1")) CHECK((end.body[0].r - right).norm() < 0.1 * R);
    }
}
