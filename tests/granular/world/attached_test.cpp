// SPDX-License-Identifier: GPL-3.0-or-later
// Particles attached to boundaries.
#include "io/error.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Scheme;

namespace attached_test {

namespace {

constexpr double R = 1e-3;

WorldOptions room(Scheme scheme = Scheme::symplectic_euler)
{
    WorldOptions o;
    o.low = {-30 * R, -30 * R, -30 * R}, o.high = {30 * R, 30 * R, 30 * R};
    o.h = 1e-5;
    o.scheme = scheme;
    return o;
}

World with_law(const WorldOptions& o, double mu = 0.5)
{
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, mu));
    return world;
}

/// A frame for particles: a sphere that touches nothing
Boundary frame()
{
    Boundary b;
    b.shape = Boundary::Shape::sphere;
    b.radius = R / 10;
    return b;
}

Vec3 turned_z(const Vec3& x, double angle)
{
    return {std::cos(angle) * x.x - std::sin(angle) * x.y, std::sin(angle) * x.x + std::cos(angle) * x.y,
            x.z};
}

}  // namespace

TEST_CASE("attached particles move rigidly with their boundary", "[granular][attached]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    WorldOptions options = room(scheme);
    options.orientation = true;
    options.gravity = {0, 0, 0};
    World world = with_law(options);
    world.add(Boundary(frame()));
    world.boundary(0).r = {R, 0, 0};
    const Vec3 X[] = {{10 * R, 0, 0}, {0, 12 * R, 3 * R}, {-7 * R, 1 * R, -2 * R}};
    for (const Vec3& x : X) world.add(Particle{.r = world.boundary(0).r + x, .radius = R, .attached_to = 0});
    world.add(Particle{.r = {0, 0, 20 * R}, .radius = R});
    const double w = 31, h = options.h;
    const Vec3 v{0.02, -0.01, 0.03};
    world.boundary(0).omega = {0, 0, w}, world.boundary(0).v = v;
    const long n = 20000;  // about one turn
    world.step(n);
    const double t = static_cast<double>(n) * h;
    CHECK(world.rebuilds() > 5);
    const auto all = world.particles();
    for (int k = 0; k < 3; ++k) {
        const Vec3 d = turned_z(X[k], w * t), r = Vec3{R, 0, 0} + t * v + d, u = v + Vec3{0, 0, w}.cross(d);
        CHECK((all[k].r - r).norm() < 1e-8 * R + 1e-10);
        CHECK((all[k].v - u).norm() < 1e-6);
        CHECK(all[k].omega.z == Approx(w));
        CHECK(std::abs(all[k].e[3]) == Approx(std::abs(std::sin(w * t / 2))).margin(1e-4));
    }
    CHECK(all[3].v.x == 0);
}

TEST_CASE("a grain bounces on an attached particle as on a moving one", "[granular][attached]")
{
    // In the frame of the attached particle the collision is that with a fixed one.
    const auto rebound = [](double u) {
        World world = with_law([] {
            WorldOptions o = room();
            o.gravity = {0, 0, 0};
            return o;
        }());
        world.add(Boundary(frame()));
        world.boundary(0).r = {0, 0, -20 * R}, world.boundary(0).v = {0, 0, u};
        world.add(Particle{.r = {0, 0, -10 * R}, .radius = R, .attached_to = 0});
        world.add(Particle{.r = {0, 0, -7.5 * R}, .radius = R, .v = {0, 0, u - 0.5}});
        world.step(1500);
        CHECK(world.watch().work ==
              Approx(u == 0 ? 0 : world.watch().impulse.z * u).epsilon(1e-2).margin(1e-12));
        return world.particles()[1].v.z - u;
    };
    const double at_rest = rebound(0);
    CHECK(at_rest > 0.1);
    CHECK(rebound(0.2) == Approx(at_rest).epsilon(1e-3));
    CHECK(rebound(-0.3) == Approx(at_rest).epsilon(1e-3));
}

TEST_CASE("the loads of attached particles are those of their boundary", "[granular][attached]")
{
    // A grain rests on three attached ones: the boundary carries its weight, and the torque is that of the
    // weight about the reference point.
    World world = with_law(room());
    Boundary b = frame();
    b.r = {-15 * R, 0, -20 * R};
    world.add(b);
    for (int k = 0; k < 3; ++k) {
        const double a = 2 * M_PI * k / 3;
        world.add(Particle{
            .r = {1.15 * R * std::cos(a), 1.15 * R * std::sin(a), 0}, .radius = R, .attached_to = 0});
    }
    world.add(Particle{.r = {0, 0, std::sqrt(4 - 1.15 * 1.15) * R}, .radius = R});
    world.step(40000);
    const auto total = world.totals();
    const double weight = 4.0 / 3 * M_PI * R * R * R * glass().density * 9.81;
    CHECK(total.contacts == 3);
    CHECK(total.on_boundary[0].F.z == Approx(-weight).epsilon(1e-4));
    CHECK(std::abs(total.on_boundary[0].F.x) < 1e-4 * weight);
    CHECK(total.on_boundary[0].T.y == Approx(15 * R * weight).epsilon(1e-4));
    const granular::Wrench same = world.wrench(0);
    CHECK((same.F - total.on_boundary[0].F).norm() < 1e-12);
    CHECK((same.T - total.on_boundary[0].T).norm() < 1e-12);
}

TEST_CASE("a world with attached particles that is restored continues with the same bytes",
          "[granular][attached]")
{
    const auto fresh = [] {
        World world = with_law(room());
        world.add(Boundary(frame()));
        world.before_each_step([](World& w) {
            w.boundary(0).omega = {5 * std::sin(40 * w.t()), 0, 20},
            w.boundary(0).v = {0, 0, std::sin(60 * w.t())};
        });
        for (int k = 0; k < 12; ++k) {
            const double a = 2 * M_PI * k / 12;
            world.add(
                Particle{.r = {8 * R * std::cos(a), 8 * R * std::sin(a), 0}, .radius = R, .attached_to = 0});
            world.add(Particle{.r = {8 * R * std::cos(a), 8 * R * std::sin(a), 4 * R}, .radius = R});
        }
        return world;
    };
    World whole = fresh();
    whole.step(1500);
    const std::string saved = whole.to_bytes("run");
    World world = fresh();
    world.from_bytes(saved, "run", "file");
    whole.step(2500), world.step(2500);
    CHECK(whole.to_bytes("run") == world.to_bytes("run"));
}

TEST_CASE("a particle is not attached to an unknown boundary or to one with a mass", "[granular][attached]")
{
    World world = with_law(room());
    Boundary tool = frame();
    tool.mass = 1;
    world.add(tool);
    CHECK_THROWS_AS(world.add(Particle{.radius = R, .attached_to = 0}), io::InvalidInput);
    CHECK_THROWS_AS(world.add(Particle{.radius = R, .attached_to = 1}), io::InvalidInput);
}

}  // namespace attached_test
