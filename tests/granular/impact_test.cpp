// SPDX-License-Identifier: GPL-3.0-or-later
// Two spheres, or one and a wall: closed forms.                                       Fang (2022), Secs. 7.1.1 to 7.1.3
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using granular::DoubleWorld;
using granular::Scheme;

namespace {

constexpr double R = 0.5;

WorldOptions weightless(double h, Scheme scheme = Scheme::symplectic_euler)
{
    WorldOptions o;
    o.low = {-3, -3, -3}, o.high = {3, 3, 3};
    o.gravity = {0, 0, 0};
    o.h = h;
    o.scheme = scheme;
    return o;
}

std::vector<Particle> approaching()
{
    Particle a, b;
    a.radius = b.radius = R, a.mass = b.mass = 1;
    a.r = {-0.5005, 0, 0}, b.r = {0.5005, 0, 0};
    a.v = {1, 0, 0}, b.v = {-1, 0, 0};
    return {a, b};
}

/// |v'/v| of a head-on collision, in double precision and as the world has it
double rebound(double e, double h, Scheme scheme)
{
    DoubleWorld world(weightless(h, scheme), hertz_mindlin(soft(), e));
    world.particle = approaching();
    world.step(std::lround(0.5 / h));
    return std::abs(world.particle[0].v.x);
}

}  // namespace

TEST_CASE("a head-on collision has the restitution it is told, whatever the scheme (long)",
          "[granular][impact]")
{
    const std::pair<Scheme, double> most[] = {{Scheme::symplectic_euler, 5e-4},
                                              {Scheme::velocity_verlet, 5e-4},
                                              {Scheme::chung, 1e-4},
                                              {Scheme::extended_taylor, 5e-3},
                                              {Scheme::forward_euler, 1e-2}};
    for (const auto& [scheme, bound] : most)
        for (int k = 1; k <= 10; ++k) {
            const double e = 0.1 * k, h = 3e-5, truth = rebound(e, h, scheme);
            INFO(static_cast<int>(scheme) << " e = " << e);
            CHECK(truth == Approx(e).margin(bound));

            World world(weightless(h, scheme), {soft()});
            world.set_law(0, 0, hertz_mindlin(soft(), e));
            for (const Particle& p : approaching()) world.add(p);
            world.step(std::lround(0.5 / h));
            const auto after = world.particles();
            CHECK(std::abs(after[0].v.x) == Approx(truth).margin(1e-5));
            CHECK(after[0].v.x == -after[1].v.x);
            CHECK(after[0].v.y == 0);
        }
}

TEST_CASE("the restitution converges with the first order of the step", "[granular][impact]")
{
    // The worst of where in a step they may meet: the error of one run depends on it.
    const auto error = [](double h, Scheme scheme) {
        double worst = 0;
        for (int k = 0; k < 16; ++k) {
            DoubleWorld world(weightless(h, scheme), hertz_mindlin(soft(), 0.5));
            world.particle = approaching();
            world.particle[0].r.x -= h * k / 16;
            world.step(std::lround(0.2 / h));
            worst = std::max(worst, std::abs(std::abs(world.particle[0].v.x) - 0.5));
        }
        return worst;
    };
    for (const Scheme scheme : {Scheme::symplectic_euler, Scheme::extended_taylor, Scheme::forward_euler}) {
        const double order = std::log2(error(4e-5, scheme) / error(1e-5, scheme)) / 2;
        INFO(static_cast<int>(scheme));
        CHECK(order == Approx(1).margin(0.15));
    }
}

TEST_CASE("a sphere that may not turn slides as far as Coulomb says (long)", "[granular][impact]")
{
    constexpr double g = 9.81, v = 5, h = 2e-5;
    for (const double mu : {0.1, 0.3, 0.5}) {
        WorldOptions o = weightless(h);
        o.low = {-1, -1, -1}, o.high = {15, 1, 2};
        o.gravity = {0, 0, -g};
        World world(o, {soft()});
        world.set_law(0, 0, hertz_mindlin(soft(), 1e-7, mu));
        world.add(granular::Boundary{});
        world.set_omega_locked(true);
        // pressed in as far as its weight does
        const double E_eff = granular::effective_modulus(soft(), soft());
        const double delta = std::pow(0.75 * g / (E_eff * std::sqrt(R)), 2.0 / 3);
        Particle p;
        p.radius = R, p.mass = 1, p.r = {0, 0, R - delta}, p.v = {0, 0, 0};
        world.add(p);
        world.step(std::lround(0.08 / h));
        world.set_velocity(0, {v, 0, 0}, {0, 0, 0});
        const double start = world.particles()[0].r.x;
        double least = 1e9;
        for (int k = 0; k < 400000 && world.particles()[0].v.x > 1e-7; ++k) {
            world.step();
            const auto c = world.contacts();
            REQUIRE(c.size() == 1);
            const double F_t = std::hypot(c[0].F.x, c[0].F.y);
            least = std::min(least, mu * std::abs(c[0].F.z) - F_t);
        }
        INFO("mu = " << mu);
        CHECK(world.particles()[0].r.x - start == Approx(v * v / (2 * mu * g)).epsilon(3e-4));
        CHECK(least > -1e-6);
    }
}

TEST_CASE("an oblique impact that slides throughout leaves with the spin of the closed form",
          "[granular][impact]")
{
    constexpr double e = 1, mu = 0.3, v_n = 3.132, h = 2e-6;
    for (const double angle : {65., 75., 85.}) {  // from the normal, in degrees
        const double v_t = v_n * std::tan(angle * std::numbers::pi / 180);
        const auto run = [&](auto& world, auto after) {
            world.step(std::lround(0.06 / h));
            return after(world);
        };
        Particle p;
        p.radius = R, p.mass = 1, p.r = {0, 0, R + 1e-4}, p.v = {v_t, 0, -v_n};
        WorldOptions o = weightless(h);
        o.low = {-1, -1, -1}, o.high = {9, 1, 3};
        World world(o, {soft()});
        world.set_law(0, 0, hertz_mindlin(soft(), e, mu));
        world.add(granular::Boundary{});
        world.add(p);
        const Particle q = run(world, [](World& w) { return w.particles()[0]; });
        INFO("angle " << angle);
        CHECK(q.v.x / v_t ==
              Approx(1 - mu * (1 + e) / std::tan(angle * std::numbers::pi / 180)).epsilon(1e-4));
        CHECK(q.omega.y == Approx(2.5 * mu * (1 + e) * v_n / R).epsilon(1e-4));
    }
}

TEST_CASE("a boundary feels the force and the torque of what lies on it", "[granular][impact]")
{
    constexpr double g = 9.81;
    WorldOptions o = weightless(1e-4);
    o.gravity = {0, 0, -g};
    World world(o, {soft()});
    world.set_law(0, 0, hertz_mindlin(soft(), 0.1, 0.3));
    granular::Boundary floor;
    floor.r = {0.5, -0.25, 0};
    world.add(floor);
    Particle p;
    p.radius = R, p.mass = 1, p.r = {1, 0.5, R};
    world.add(p);
    world.step(40000);
    const granular::Wrench w = world.wrench(0);
    CHECK(w.F.z == Approx(-g).epsilon(1e-5));
    CHECK(w.T.x == Approx(-g * 0.75).epsilon(1e-5));
    CHECK(w.T.y == Approx(g * 0.5).epsilon(1e-5));
    const auto c = world.contacts();
    REQUIRE(c.size() == 1);
    CHECK(c[0].C.z == Approx(0).margin(1e-9));
    CHECK(c[0].delta == Approx(R - world.particles()[0].r.z).margin(2.1e-9));  // a unit of positions
}

TEST_CASE("a contact goes on when particles are added", "[granular][impact]")
{
    const auto run = [&](bool another) {
        WorldOptions o = weightless(1e-4);
        o.gravity = {0.5, 0, -9.81};  // down a slope that it sticks on
        World world(o, {soft()});
        world.set_law(0, 0, hertz_mindlin(soft(), 0.1, 0.3));
        world.set_omega_locked(true);
        world.add(granular::Boundary{});
        Particle p;
        p.radius = R, p.mass = 1, p.r = {-1, 0, R};
        world.add(p);
        world.step(20000);
        p.r = {1.5, 0, 2};
        if (another) world.add(p);
        world.step(1000);
        return world.contacts().at(0);
    };
    const auto alone = run(false), with_another = run(true);
    CHECK(alone.u.x > 1e-7);
    CHECK(with_another.u.x == Approx(alone.u.x).epsilon(1e-4));
    CHECK(with_another.F.x == Approx(-0.5).epsilon(1e-4));
}
