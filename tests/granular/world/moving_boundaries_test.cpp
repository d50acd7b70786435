// SPDX-License-Identifier: GPL-3.0-or-later
// External actions on particles: gravity, applied forces, boundaries with prescribed motion, tools; and
// replicas.
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Scheme;

namespace moving_boundaries_test {

namespace {

constexpr double R = 1e-3;

WorldOptions room(double h)
{
    WorldOptions o;
    o.low = {-0.02, -0.02, -0.02}, o.high = {0.02, 0.02, 0.02};
    o.h = h;
    return o;
}

World glass_world(const WorldOptions& o)
{
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.6, 0.4));
    return world;
}

/// n³ particles on a slightly perturbed lattice, which collapse into a heap
void add_heap(World& world, int n, std::uint16_t replica, unsigned seed)
{
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> shift(-0.03 * R, 0.03 * R);
    for (int k = 0; k < n * n * n; ++k) {
        Particle p;
        p.radius = R, p.replica = replica;
        const int column = k % n, row = k / n % n, layer = k / (n * n);
        p.r = 2.1 * R * Vec3{column - 0.5 * (n - 1), row - 0.5 * (n - 1), layer + 0.6};
        p.r += {shift(engine), shift(engine), shift(engine)};
        world.add(p);
    }
}

}  // namespace

TEST_CASE("the position in free fall is the closed form of each scheme", "[granular][integrator]")
{
    const double h = 1e-3, g = 9.81;
    const long n = 40;
    const double t = h * static_cast<double>(n);
    // x_n - x_0 - v_0 t over g h²/2, in closed form
    const std::pair<Scheme, double> all[] = {{Scheme::symplectic_euler, double(n * (n + 1))},
                                             {Scheme::velocity_verlet, double(n * n)},
                                             {Scheme::forward_euler, double(n * (n - 1))},
                                             {Scheme::extended_taylor, double(n * n)},
                                             {Scheme::chung, double(n * n)}};
    for (const auto& [scheme, sum] : all) {
        WorldOptions o = room(h);
        o.scheme = scheme;
        World world = glass_world(o);
        world.add(Particle{.r = {0, 0, 0.01}, .radius = R, .v = {0, 0, 0.2}});
        world.step(n);
        const Particle p = world.particles()[0];
        INFO("scheme " << static_cast<int>(scheme));
        CHECK(p.v.z == Approx(0.2 - g * t).epsilon(1e-6));
        CHECK(p.r.z == Approx(0.01 + 0.2 * t - 0.5 * g * h * h * sum).margin(2e-9));
    }
}

TEST_CASE("displacements below the resolution of a step accumulate without loss", "[granular][integrator]")
{
    // positions have a resolution of 2^-29 of a cell, remainders of 1/1024 of that
    const double h = 1e-7, R = 0.05, grain = 1.1 * 2 * R / (1 << 29) / 1024;
    const long steps = 50000;
    for (const Scheme scheme : {Scheme::symplectic_euler, Scheme::velocity_verlet}) {
        WorldOptions o;
        o.low = {-1, -1, -1}, o.high = {1, 1, 1};
        o.h = h, o.gravity = {0, 0, 0}, o.scheme = scheme;
        World world = glass_world(o);
        const double grains[] = {0.01, 0.3, 0.9, 5, 700, 1023.7, 2e5};
        std::vector<Vec3> begin;
        for (int k = 0; k < 7; ++k)
            for (const double sign : {-1., 1.}) {
                const double v = sign * grains[k] * grain / h;
                begin.push_back({0.12 * (k - 3) + 0.01234567, sign * 0.2, 0.3});
                world.add(Particle{.r = begin.back(), .radius = R, .v = {v, -v, v}});
            }
        world.step(steps);
        for (std::size_t k = 0; k < begin.size(); ++k) {
            const Particle p = world.particles()[k];
            const Vec3 went = p.r - begin[k];
            INFO("scheme " << static_cast<int>(scheme) << ", " << p.v.x * h / grain << " grains in a step");
            const double way = p.v.x * h * static_cast<double>(steps);
            // single precision of the velocity, a few resolution units, rounding of two positions
            const double margin = 1e-6 * std::abs(way) + 8 * grain + 1e-15;
            CHECK(std::abs(went.x - way) < margin);
            CHECK(std::abs(went.y + way) < margin);
            CHECK(std::abs(went.z - way) < margin);
        }
    }
}

TEST_CASE("velocities are stored with a relative error below 1e-9, however they are set", "[granular]")
{
    World world = glass_world(room(1e-6));
    const Vec3 v = {1e-6, 0.1, -1. / 3}, omega = {100. / 7, -1e-4 / 3, 1. / 7};
    world.add(Particle{.r = {-0.01, 0, 0}, .radius = R, .v = v, .omega = omega});
    world.add(Particle{.r = {0.01, 0, 0}, .radius = R});
    world.set_velocity(1, v, omega);
    world.step(0);
    const auto far = [](const Vec3& a, const Vec3& b) {
        return std::max({std::abs(a.x / b.x - 1), std::abs(a.y / b.y - 1), std::abs(a.z / b.z - 1)});
    };
    for (const Particle& p : world.particles()) CHECK(std::max(far(p.v, v), far(p.omega, omega)) < 1e-9);
    const auto before = world.particles();
    world.add(Particle{.r = {0, 0.01, 0}, .radius = R});
    world.step(0);
    for (std::size_t k = 0; k < before.size(); ++k) {
        const Particle p = world.particles()[k];
        CHECK(std::max(far(p.v, v), far(p.omega, omega)) < 1e-9);
        CHECK((p.r - before[k].r).norm() < 1e-14);  // the resolution is 4e-15 m
    }
}

TEST_CASE("all schemes converge to the same heap as the step is refined", "[granular][integrator]")
{
    // positions after 12 ms, with many rebuilds of the neighbour list
    const auto end = [](Scheme scheme, double h) {
        WorldOptions o = room(h);
        o.scheme = scheme;
        o.skin = 0.02;
        World world = glass_world(o);
        world.add(Boundary{});
        add_heap(world, 2, 0, 3);
        world.step(std::lround(0.012 / h));
        CHECK(world.rebuilds() > 20);
        return world.particles();
    };
    const auto apart = [](const std::vector<Particle>& a, const std::vector<Particle>& b) {
        double most = 0;
        for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, (a[k].r - b[k].r).norm());
        return most;
    };
    const auto reference = end(Scheme::velocity_verlet, 2e-7);
    for (const Scheme s : {Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung}) {
        const double coarse = apart(end(s, 4e-6), reference), fine = apart(end(s, 1e-6), reference);
        INFO("scheme " << static_cast<int>(s) << ": " << coarse << " and " << fine << " m");
        CHECK(fine < 0.4 * coarse);
        CHECK(coarse < 3e-6);
    }
}

TEST_CASE("an applied force accelerates its particle until it is changed", "[granular]")
{
    WorldOptions o = room(1e-4);
    o.gravity = {0, 0, 0};
    World world = glass_world(o);
    world.add(Particle{.r = {-0.01, 0, 0}, .radius = R});
    const auto pushed = world.add(Particle{.r = {0.01, 0, 0}, .radius = R});
    const double mass = world.particles()[pushed].mass;
    world.set_force(pushed, {0, 3e-6, 0});
    world.step(100);
    CHECK(world.particles()[pushed].v.y == Approx(3e-6 / mass * 0.01).epsilon(1e-6));
    CHECK(world.particles()[0].v.norm() == 0);
    world.set_force(pushed, {0, 0, 0});
    const double v = world.particles()[pushed].v.y;
    world.step(100);
    CHECK(world.particles()[pushed].v.y == v);
    CHECK_THROWS_WITH(world.set_force(7, {0, 0, 0}), "force: no particle has this id, got 7");
}

TEST_CASE("a rotating boundary moves the particle on it", "[granular][boundary]")
{
    // a floor that tips about y by 0.1 rad: a smooth ball on it then slides down
    World world(room(5e-6), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.2));
    world.add(Boundary{});
    world.add(Particle{.r = {0, 0, 0.9999 * R}, .radius = R});
    world.before_each_step([](World& w) { w.boundary(0).omega = {0, w.t() < 0.1 ? 1. : 0., 0}; });
    world.step(20000);
    CHECK(world.boundary(0).axis.x == Approx(std::sin(0.1)).epsilon(1e-9));
    CHECK(world.boundary(0).axis.z == Approx(std::cos(0.1)).epsilon(1e-9));
    const Vec3 before = world.particles()[0].v;
    world.step(10000);
    const Vec3 gained = world.particles()[0].v - before, n = world.boundary(0).axis;
    CHECK(gained.dot({n.z, 0, -n.x}) == Approx(9.81 * std::sin(0.1) * 0.05).epsilon(1e-3));
    CHECK(std::abs(gained.dot(n)) < 3e-3);  // it still bounces slightly
}

TEST_CASE("a free plate comes to rest on particles that support it", "[granular][boundary]")
{
    World world = glass_world(room(5e-6));
    world.add(Boundary{});
    for (const double x : {-5., 0., 5.})
        for (const double y : {-3., 3.}) world.add(Particle{.r = {x * R, y * R, R}, .radius = R});
    Boundary plate;
    plate.axis = {0, 0, -1}, plate.r = {0, 0, 2.05 * R};
    plate.mass = 0.002, plate.free = {false, false, true}, plate.F = {0, 0, -0.28};
    const int top = world.add(plate);
    world.step(150000);
    CHECK(std::abs(world.boundary(top).v.z) < 1e-6);
    const double load = 0.002 * 9.81 + 0.28, weight = 6 * world.particles()[0].mass * 9.81;
    CHECK(world.wrench(top).F.z == Approx(load).epsilon(1e-3));
    CHECK(world.wrench(0).F.z == Approx(-load - weight).epsilon(1e-3));
    // Hertz: a particle between two plates, F = 4/3 E* sqrt(R) delta^1.5 above and below
    const double E = granular::effective_modulus(glass(), glass());
    const auto pressed = [&](double F) { return std::pow(0.75 * F / (E * std::sqrt(R)), 2. / 3); };
    CHECK(2 * R - world.boundary(top).r.z ==
          Approx(pressed(load / 6) + pressed((load + weight) / 6)).epsilon(2e-3));
}

TEST_CASE("a replica moves as a system of its own does", "[granular][replicas]")
{
    const auto options = room(5e-6);
    World all = glass_world(options);
    all.add(Boundary{});
    for (const int replica : {0, 1, 2}) add_heap(all, 3, static_cast<std::uint16_t>(replica), 5 + replica);
    all.step(1000);
    const auto together = all.particles();
    double weight = 0;
    for (const int replica : {0, 1, 2}) {
        World alone = glass_world(options);
        alone.add(Boundary{});
        add_heap(alone, 3, 0, 5 + replica);
        alone.step(1000);
        const auto p = alone.particles();
        double most = 0;
        for (std::size_t k = 0; k < p.size(); ++k)
            most = std::max(most, (p[k].r - together[27 * replica + k].r).norm());
        CHECK(most < 1e-9);  // the lists are rebuilt at different times, which changes rounding
        CHECK(all.wrench(0, replica).F.z == Approx(alone.wrench(0).F.z).epsilon(1e-3));
        weight += all.wrench(0, replica).F.z;
        CHECK(together[27 * replica].replica == replica);
    }
    CHECK(all.wrench(0).F.z == Approx(weight).epsilon(1e-12));
}

TEST_CASE("the neighbour list is rebuilt when a particle has moved by half the skin and not before",
          "[granular][neighbours]")
{
    // A ball bounces between two walls whose distance is below half the skin. The sum of its displacements
    // grows, its displacement from the position at the build does not.
    WorldOptions o = room(1e-6);
    o.gravity = {0, 0, 0};
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 1));
    Boundary left, right;
    left.axis = {1, 0, 0}, left.r = {-1.02 * R, 0, 0};
    right.axis = {-1, 0, 0}, right.r = {1.02 * R, 0, 0};
    world.add(left), world.add(right);
    world.add(Particle{.r = {0, 0, 0}, .radius = R, .v = {0.5, 0, 0}});
    double most = 0;
    for (int k = 0; k < 4000; ++k) {
        world.step(5);
        if (k > 3900) most = std::max(most, world.kinetic_energy());
    }
    CHECK(world.rebuilds() == 1);
    CHECK(most == Approx(0.5 * world.particles()[0].mass * 0.25).epsilon(0.01));
}

}  // namespace moving_boundaries_test
