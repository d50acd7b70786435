// SPDX-License-Identifier: GPL-3.0-or-later
// What single laws of force do to a sphere on a floor, or to two spheres, in World and in closed form.
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using namespace hilda::granular;

namespace {

// it sinks in by a thousandth of a metre, with half of the critical damping
constexpr double R = 0.125, m = 1, g = 10, I = 0.4 * m * R * R, k_n = 1e4, k_t = 8000, sunk = m * g / k_n;

PairLaw on_springs(float gamma_t = 0)
{
    PairLaw law;
    law.normal = Hooke{.k_n = k_n, .gamma_n = 100};
    law.tangential = Mindlin{.spring = {.k_t = k_t, .c = 0, .gamma_t = gamma_t}, .cap = {1, 1}};
    return law;
}

WorldOptions on_floor(double h)
{
    WorldOptions o;
    o.low = {-1, -1, -0.5}, o.high = {3, 1, 0.5};
    o.gravity = {0, 0, -g}, o.h = h;
    return o;
}

/// In balance with a floor, but for these velocities
Particle resting(const Vec3& v, const Vec3& omega)
{
    return {.r = {0, 0, R - sunk}, .radius = R, .v = v, .omega = omega, .mass = m};
}

World ball(const PairLaw& law, const Particle& p, double h = 1e-4)
{
    World world(on_floor(h), {soft()});
    world.set_law(0, 0, law);
    world.add(Boundary{});
    world.add(p);
    return world;
}

Particle now(const World& world) { return world.particles()[0]; }
Particle now(const DoubleWorld& world) { return world.particle[0]; }

/// What it gains of v along `way` in 0.5 s, from 0.25 s on, in steps of 1e-4 s
template <class W>
double gain(W& world, const Vec3& way)
{
    world.step(2500);
    const double before = now(world).v.dot(way);
    world.step(5000);
    return now(world).v.dot(way) - before;
}

}  // namespace

TEST_CASE("a rolling ball is held back by 5/7 of the coefficient of rolling", "[granular][laws]")
{
    // the torque μ_r R N against the inertia about the contact, 7/5 m R²
    const float mu_r = 0.0625f;
    const std::pair<const char*, RollingLaws> all[] = {
        {"constant torque", ConstantTorque{.mu_r = mu_r, .slow = 1e-4f}},
        {"half radius", ConstantTorque{.mu_r = 2 * mu_r, .slow = 1e-4f, .half_radius = 1}},
        {"epsd", Epsd{.mu_r = mu_r, .eta_r = 0.3f}},
        {"pseudo-force", PseudoForce{.mu_r = mu_r, .k_r = 1, .eta_r = 0.3f}}};
    for (const auto& [name, rolling] : all) {
        INFO(name);
        PairLaw law = on_springs(50);
        law.rolling = rolling;
        const Particle rolling_on = resting({0.8, 0.6, 0}, {-0.6 / R, 0.8 / R, 0});
        const Vec3 way = {0.8, 0.6, 0};
        DoubleWorld in_double(on_floor(1e-4), law);
        in_double.particle = {rolling_on}, in_double.boundary = {Boundary{}};
        CHECK(gain(in_double, way) == Approx(-5. / 7 * mu_r * g * 0.5).epsilon(1e-6));
        World world = ball(law, rolling_on);
        CHECK(gain(world, way) == Approx(-5. / 7 * mu_r * g * 0.5).epsilon(1e-5));
        const Particle p = now(world);
        CHECK(p.omega.y * R == Approx(p.v.x).epsilon(1e-4));
        CHECK(-p.omega.x * R == Approx(p.v.y).epsilon(1e-4));
        CHECK(0.6 * p.v.x == Approx(0.8 * p.v.y).epsilon(1e-4));
    }
}

TEST_CASE("turning loses nothing to single precision, however little a step takes of it (long)",
          "[granular][laws]")
{
    // in a step ω loses less than a digit of its last place
    constexpr double mu_r = 0.01, h = 1e-6, v = 10;
    PairLaw law = on_springs(50);
    law.rolling = ConstantTorque{.mu_r = float(mu_r), .slow = 1e-4f};
    WorldOptions o = on_floor(h);
    o.low.x = -2, o.high.x = 6;
    World world(o, {soft()});
    world.set_law(0, 0, law);
    world.add(Boundary{});
    world.add(resting({v, 0, 0}, {0, v / R, 0}));
    world.step(100000);
    const double before = now(world).v.x, turned = now(world).omega.y;
    world.step(300000);
    CHECK(now(world).v.x - before == Approx(-5. / 7 * mu_r * g * 0.3).epsilon(5e-5));
    CHECK(R * (now(world).omega.y - turned) == Approx(-5. / 7 * mu_r * g * 0.3).epsilon(5e-5));
}

TEST_CASE("a ball that a spring keeps from rolling swings", "[granular][laws]")
{
    // m x'' = -k_t (x - y), 2/5 m y'' = k_t (x - y) - k_t y with y = R θ: two modes, of which this is the slow one
    const double Lambda = 3 - std::sqrt(6.5), omega = std::sqrt(Lambda * k_t / m), v = 0.01;
    for (const RollingLaws& rolling :
         {RollingLaws(Epsd{.mu_r = 0.5f}), RollingLaws(PseudoForce{.mu_r = 0.5f, .k_r = 1})}) {
        PairLaw law = on_springs();
        law.rolling = rolling;
        World world = ball(law, resting({v, 0, 0}, {0, (1 - Lambda) * v / R, 0}), 2e-5);
        world.step(0);
        const int periods = 8;
        std::vector<double> crossings;
        double last = v, most = 0, mean = 0;
        while (crossings.size() < 2 * periods + 1 && world.t() < 2) {
            world.step();
            const Particle p = now(world);
            if (last * p.v.x < 0) crossings.push_back(world.t() - 2e-5 * p.v.x / (p.v.x - last));
            if (!crossings.empty()) mean += p.r.x;
            last = p.v.x;
            if (crossings.size() > 2 * periods - 1) most = std::max(most, std::abs(last));
        }
        REQUIRE(crossings.size() == 2 * periods + 1);
        const double time = crossings.back() - crossings.front();
        CHECK(2 * std::numbers::pi * periods / time == Approx(omega).epsilon(1e-4));
        CHECK(most == Approx(v).epsilon(1e-3));
        CHECK(std::abs(mean * 2e-5 / time) < 0.01 * v / omega);  // about where it began
    }
}

TEST_CASE("a ball that spins on the spot stops, and swings back by the spring", "[granular][laws]")
{
    const double a = std::sqrt(R * sunk), mu = 0.25, cap = 2. / 3 * mu * m * g * a, omega_0 = 1.5;
    const double p = std::sqrt(k_t * a * a / 2 / I), psi = cap / (p * p * I);  // of the spring; at its bound
    const double reaches = std::asin(p * psi / omega_0) / p,
                 omega_1 = std::sqrt(omega_0 * omega_0 - p * p * psi * psi),
                 stops = reaches + omega_1 * I / cap;
    for (const double sign : {1., -1.}) {
        PairLaw law = on_springs();
        law.spin = TorsionalSpring{.mu = float(mu)};
        World world = ball(law, resting({0, 0, 0}, {0, 0, sign * omega_0}));
        double stopped = 0, back = 0;
        for (double last = omega_0; world.t() < 1.5; last = sign * now(world).omega.z) {
            world.step();
            const double omega = sign * now(world).omega.z;
            if (stopped == 0 && omega < 0) stopped = world.t() - 1e-4 * omega / (omega - last);
            back = std::min(back, omega);
        }
        CHECK(stopped == Approx(stops).epsilon(1e-3));
        CHECK(back == Approx(-p * psi).epsilon(1e-3));
        CHECK(now(world).v.norm() < 1e-5);
    }
}

TEST_CASE("a ball that may not turn slides to rest by friction without a history", "[granular][laws]")
{
    PairLaw law = on_springs();
    law.tangential = Coulomb{.spring = {.k_t = 0, .c = 0, .gamma_t = 50}, .mu_k = 0.25};
    World world = ball(law, resting({2.5, 0, 0}, {0, 0, 0}));
    world.set_omega_locked(true);
    CHECK(gain(world, {1, 0, 0}) == Approx(-0.25 * g * 0.5).epsilon(1e-4));
    // from v = μ g/γ on it is slowed down by γ v, over another v/γ
    world.step(5000);
    CHECK(std::abs(now(world).v.x) < 1e-6);
    const double slow = 0.25 * g / 50;
    CHECK(now(world).r.x == Approx((2.5 * 2.5 - slow * slow) / (2 * 0.25 * g) + slow / 50).epsilon(1e-3));
}

TEST_CASE("a linear contact without tension throws back faster", "[granular][laws]")
{
    // it ends where the force is zero and not where the overlap is
    const double beta = 50 / m, omega_0 = std::sqrt(k_n / m),
                 omega = std::sqrt(omega_0 * omega_0 - beta * beta), half = std::numbers::pi,
                 early = half - std::atan2(2 * beta * omega, omega * omega - beta * beta);
    for (const int clamped : {0, 1}) {
        PairLaw law;
        law.normal = Hooke{.k_n = k_n, .gamma_n = 100, .clamped = clamped};
        WorldOptions o;
        o.low = {-1, -1, -1}, o.high = {1, 1, 1};
        o.gravity = {0, 0, 0}, o.h = 2e-6;
        World world(o, {soft()});
        world.set_law(0, 0, law);
        world.add(Boundary{});
        world.add(Particle{.r = {0, 0, R}, .radius = R, .v = {0, 0, -1}, .mass = m});
        world.step(40000);
        CHECK(world.contacts().empty());
        CHECK(now(world).v.z ==
              Approx(std::exp(-beta / omega * (clamped != 0 ? early : half))).epsilon(1e-3));
    }
}

TEST_CASE("spheres that stick part above the pull of their cohesion and not below", "[granular][laws]")
{
    constexpr double E = 1e5, k = 12000, pi = std::numbers::pi;
    PairLaw constant = on_springs(), area;
    constant.cohesion = ConstantCohesion{.F_c = 8};
    area.normal = Hertz{.E_eff = float(E), .c = float(damping(0.3))};
    area.cohesion = Sjkr{.k = float(k)};
    struct Pair {
        const char* name;
        PairLaw law;
        double rests, pull;  // overlap without a load [m], what parts them [N]
    };
    const Pair all[] = {{"constant", constant, 8 / k_n, 8},
                        {"sjkr", area, std::pow(1.5 * pi * k / (2 * E), 2) * R / 2,
                         std::pow(pi * k, 3) * R * R / 4 / (12 * E * E)}};
    for (const Pair& of : all)
        for (const double share : {0.98, 1.02}) {
            INFO(of.name << ", " << share << " of the pull");
            WorldOptions o;
            o.low = {-2, -1, -1}, o.high = {2, 1, 1};
            o.gravity = {0, 0, 0}, o.h = 1e-4;
            World world(o, {soft()});
            world.set_law(0, 0, of.law);
            for (const double side : {-1., 1.})
                world.add(Particle{.r = {side * (R - of.rests / 2), 0, 0}, .radius = R, .mass = m});
            world.step(1000);
            CHECK(world.particles()[1].v.norm() < 1e-4);
            world.before_each_step([&](World& w) {
                const double F = share * of.pull * std::min(1., w.t() - 0.1);
                w.set_force(0, {-F, 0, 0}), w.set_force(1, {F, 0, 0});
            });
            while (world.t() < 2.5 && !world.contacts().empty()) world.step(100);
            CHECK(world.contacts().empty() == (share > 1));
        }
}
