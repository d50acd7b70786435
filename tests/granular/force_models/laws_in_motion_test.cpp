// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of a sphere on a floor, or of two spheres, under single force laws: World against closed forms.
#include "granular/case/case_file.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using namespace hilda::granular;

namespace laws_in_motion_test {

namespace {

// static overlap of 1 mm, half of the critical damping
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

/// A particle in static equilibrium with the floor, with the given velocities
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

/// Change of the velocity along `direction` from t = 0.25 s to 0.75 s, in steps of 1e-4 s
template <class W>
double gain(W& world, const Vec3& direction)
{
    world.step(2500);
    const double before = now(world).v.dot(direction);
    world.step(5000);
    return now(world).v.dot(direction) - before;
}

}  // namespace

TEST_CASE("a rolling ball decelerates by 5/7 of the coefficient of rolling friction times g",
          "[granular][laws]")
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
        const Vec3 direction = {0.8, 0.6, 0};
        DoubleWorld in_double(on_floor(1e-4), law);
        in_double.particle = {rolling_on}, in_double.boundary = {Boundary{}};
        CHECK(gain(in_double, direction) == Approx(-5. / 7 * mu_r * g * 0.5).epsilon(1e-6));
        World world = ball(law, rolling_on);
        CHECK(gain(world, direction) == Approx(-5. / 7 * mu_r * g * 0.5).epsilon(1e-5));
        const Particle p = now(world);
        CHECK(p.omega.y * R == Approx(p.v.x).epsilon(1e-4));
        CHECK(-p.omega.x * R == Approx(p.v.y).epsilon(1e-4));
        CHECK(0.6 * p.v.x == Approx(0.8 * p.v.y).epsilon(1e-4));
    }
}

TEST_CASE("a deceleration of rolling below single precision per step is not lost (long)", "[granular][laws]")
{
    // the change of ω per step is below one unit in its last place
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

TEST_CASE("a ball on a rolling spring oscillates with the frequency of the closed form", "[granular][laws]")
{
    // m x'' = -k_t (x - y), 2/5 m y'' = k_t (x - y) - k_t y with y = R θ; the initial velocities excite the
    // slow mode
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
        CHECK(std::abs(mean * 2e-5 / time) < 0.01 * v / omega);  // oscillates about the initial position
    }
}

TEST_CASE("a spinning ball stops and rebounds by the torsional spring", "[granular][laws]")
{
    const double a = std::sqrt(R * sunk), mu = 0.25, cap = 2. / 3 * mu * m * g * a, omega_0 = 1.5;
    const double p = std::sqrt(k_t * a * a / 2 / I),
                 psi = cap / (p * p * I);  // spring frequency; angle at the bound
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

TEST_CASE("a ball with locked rotation slides to rest under friction without history", "[granular][laws]")
{
    PairLaw law = on_springs();
    law.tangential = Coulomb{.spring = {.k_t = 0, .c = 0, .gamma_t = 50}, .mu_k = 0.25};
    World world = ball(law, resting({2.5, 0, 0}, {0, 0, 0}));
    world.set_omega_locked(true);
    CHECK(gain(world, {1, 0, 0}) == Approx(-0.25 * g * 0.5).epsilon(1e-4));
    // below v = μ g/γ the deceleration is γ v; the remaining distance is v/γ
    world.step(5000);
    CHECK(std::abs(now(world).v.x) < 1e-6);
    const double slow = 0.25 * g / 50;
    CHECK(now(world).r.x == Approx((2.5 * 2.5 - slow * slow) / (2 * 0.25 * g) + slow / 50).epsilon(1e-3));
}

TEST_CASE("a clamped linear contact has a higher rebound velocity", "[granular][laws]")
{
    // the contact ends when the force is zero instead of the overlap
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

TEST_CASE("cohesive spheres separate above their pull-off force and not below it", "[granular][laws]")
{
    constexpr double E = 1e5, k = 12000, pi = std::numbers::pi;
    PairLaw constant = on_springs(), area;
    constant.cohesion = ConstantCohesion{.F_c = 8};
    area.normal = Hertz{.E_eff = float(E), .c = float(damping(0.3))};
    area.cohesion = Sjkr{.k = float(k)};
    struct Pair {
        const char* name;
        PairLaw law;
        double overlap, pull;  // equilibrium overlap without load [m], pull-off force [N]
    };
    const Pair all[] = {{"constant", constant, 8 / k_n, 8},
                        {"sjkr", area, std::pow(1.5 * pi * k / (2 * E), 2) * R / 2,
                         std::pow(pi * k, 3) * R * R / 4 / (12 * E * E)}};
    for (const Pair& of : all)
        for (const double share : {0.98, 1.02}) {
            INFO(of.name << ", " << share << " of the pull-off force");
            WorldOptions o;
            o.low = {-2, -1, -1}, o.high = {2, 1, 1};
            o.gravity = {0, 0, 0}, o.h = 1e-4;
            World world(o, {soft()});
            world.set_law(0, 0, of.law);
            for (const double side : {-1., 1.})
                world.add(Particle{.r = {side * (R - of.overlap / 2), 0, 0}, .radius = R, .mass = m});
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

TEST_CASE("two spheres with the law scaled-hooke of a case collide as its energy and damping require",
          "[granular][laws]")
{
    const double damping = GENERATE(0., 300.);
    constexpr double v = 1, k_n = 2e4, radius = 0.01, rho = 2500;
    const std::string gamma = damping > 0 ? ", \"gamma_n\": 300" : "";
    granular::Case c = granular::read_case(R"({"hilda_case": 1, "step": 1e-6, "end": 1, "gravity": [0, 0, 0],
        "domain": {"low": [0, 0, 0], "high": [0.1, 0.1, 0.1]},
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
        "laws": [{"normal": {"law": "scaled-hooke", "k_n": 2e4)" +
                                               gamma + R"(}}],
        "particles": [{"r": [0.0395, 0.05, 0.05], "v": [1, 0, 0], "radius": 0.01, "material": "glass"},
                      {"r": [0.0605, 0.05, 0.05], "v": [-1, 0, 0], "radius": 0.01, "material": "glass"}]})",
                                           "scaled");
    granular::World& world = *c.world;
    const double m = 4. / 3 * std::numbers::pi * radius * radius * radius * rho;
    double deepest = 0, energy = 0;
    for (int k = 0; k < 400; ++k) {
        world.step(10);
        for (const auto& contact : world.contacts()) deepest = std::max(deepest, contact.delta);
    }
    const auto after = world.particles();
    REQUIRE(world.contacts().empty());
    for (const Particle& p : after) energy += 0.5 * m * p.v.dot(p.v);
    CHECK(after[0].v.x == Approx(-after[1].v.x).epsilon(1e-5));
    CHECK(after[0].v.x < 0);
    // m v² = 2/5 k_n δ^(5/2)/sqrt(R)
    const double turning = std::pow(m * v * v * 5 / 2 * std::sqrt(radius) / k_n, 0.4);
    if (damping == 0) {
        CHECK(energy == Approx(m * v * v).epsilon(1e-4));
        CHECK(deepest == Approx(turning).epsilon(1e-3));
    } else {
        // the dissipation of the undamped motion, both ways, is an upper bound of the loss and close to it
        double loss = 0, u = 0;
        const double dt = 1e-8;
        for (double delta = 0, rate = 2 * v; delta >= 0 && u < 1; u += dt) {
            rate -= dt * 2 / m * std::sqrt(delta / radius) * (k_n * delta + damping * m / 2 * rate);
            delta += dt * rate;
            if (delta > 0) loss += dt * std::sqrt(delta / radius) * damping * m / 2 * rate * rate;
        }
        CHECK(loss > 0.05 * m * v * v);
        CHECK(energy == Approx(m * v * v - loss).epsilon(2e-3));
        CHECK(deepest < turning);
    }
}

}  // namespace laws_in_motion_test
