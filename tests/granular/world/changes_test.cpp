// SPDX-License-Identifier: GPL-3.0-or-later
// Changes of a world during a run: added particles, added laws, rejected input; and contacts of rotating
// bodies.
#include "io/error.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using io::InvalidInput;

namespace changes_test {

namespace {

constexpr double R = 1e-3;

WorldOptions room()
{
    WorldOptions o;
    o.low = {-20 * R, -20 * R, -20 * R}, o.high = {20 * R, 20 * R, 20 * R};
    o.h = 5e-6;
    return o;
}

World with_floor(const PairLaw& law, const WorldOptions& o = room())
{
    World world(o, {glass(), {"steel", 7800, 2e8, 0.3}});
    world.set_law(0, 0, law);
    world.add(Boundary{});
    return world;
}

}  // namespace

TEST_CASE("a particle that rotates with a turntable has no rolling or spin torque", "[granular][boundary]")
{
    PairLaw law = hertz_mindlin(glass(), 0.5, 0.5);
    law.rolling = granular::ConstantTorque{.mu_r = 0.2f, .slow = 1e-4f};
    law.spin = granular::TorsionalSpring{};
    World world = with_floor(law);
    world.boundary(0).omega = {0, 0, 20};
    world.add(Particle{.r = {0, 0, 0.9999 * R}, .radius = R, .omega = {0, 0, 20}});
    world.step(4000);
    const Particle p = world.particles()[0];
    CHECK(p.omega.z == Approx(20).epsilon(1e-6));
    CHECK(world.contacts()[0].T.norm() < 1e-15);
}

TEST_CASE("static friction acts up to mu_s and sliding friction is that of mu_k", "[granular][friction]")
{
    PairLaw law = hertz_mindlin(glass(), 0.3, 0.3);
    granular::Mindlin friction;
    law.tangential.visit([&](const auto& l) {
        if constexpr (std::is_same_v<std::decay_t<decltype(l)>, granular::Mindlin>) friction = l;
    });
    friction.cap = {0.5f, 0.3f};
    law.tangential = friction;
    World world = with_floor(law);
    world.set_omega_locked(true);
    const auto slides = world.add(Particle{.r = {-15 * R, 0, R}, .radius = R, .v = {0.2, 0, 0}});
    const auto held = world.add(Particle{.r = {0, 5 * R, R}, .radius = R});
    const double weight = world.particles()[held].mass * 9.81;
    world.step(2000);
    const double v = world.particles()[slides].v.x;
    for (int k = 1; k <= 40; ++k) {  // slowly: a suddenly applied load would oscillate up to twice its value
        world.set_force(held, {0.01 * k * weight, 0, 0});
        world.step(100);
    }
    CHECK(v - world.particles()[slides].v.x == Approx(0.3 * 9.81 * 0.02).epsilon(1e-3));
    CHECK(world.particles()[held].v.norm() < 1e-4);
    world.set_force(held, {0.55 * weight, 0, 0});
    world.step(4000);
    CHECK(world.particles()[held].v.x == Approx((0.55 - 0.3) * 9.81 * 0.02).epsilon(0.02));
}

TEST_CASE("with constant stiffness the incremental tangential law equals the law of the total displacement",
          "[granular][friction]")
{
    const auto leaving = [](const auto& tangential) {
        PairLaw law;
        law.normal = granular::Hooke{.k_n = 1e4f, .gamma_n = 0};
        law.tangential = tangential;
        WorldOptions o = room();
        o.gravity = {0, 0, 0}, o.h = 1e-6;
        World world = with_floor(law, o);
        world.add(Particle{.r = {0, 0, 1.01 * R}, .radius = R, .v = {0.05, 0, -0.3}});
        world.step(1000);
        return world.particles()[0];
    };
    const granular::TangentialSpring spring{.k_t = 8e3f};
    const Particle whole = leaving(granular::Mindlin{.spring = spring, .cap = {2, 2}});
    const Particle parts = leaving(granular::MindlinIncremental{.spring = spring, .cap = {2, 2}});
    CHECK(whole.v.z == Approx(0.3).epsilon(1e-3));
    CHECK(std::abs(whole.v.x - 0.05) > 1e-3);
    CHECK(parts.v.x == Approx(whole.v.x).epsilon(1e-4));
    CHECK(parts.omega.y == Approx(whole.omega.y).epsilon(1e-4));
}

TEST_CASE("particles can be added to a periodic gas while others cross its faces", "[granular]")
{
    WorldOptions o = room();
    o.periodic = {true, true, true}, o.gravity = {0, 0, 0};
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 1));
    for (int k = 0; k < 27; ++k) {
        const int column = k % 3, row = k / 3 % 3, layer = k / 9;
        world.add(Particle{.r = 8 * R * Vec3{column - 1., row - 1., layer - 1.},
                           .radius = R,
                           .v = {1. - 0.1 * (k % 7), 0.3, -0.5}});
    }
    int joined = 0;
    world.before_each_step([&](World& w) {
        if (w.steps() % 500 != 499) return;
        const auto all = w.particles();
        const Vec3 at{0, 0, 0};
        for (const Particle& p : all)
            if ((p.r - at).norm() < 3 * R) return;
        w.add(Particle{.r = at, .radius = R, .v = {0, 0.7, 0.2}});
        ++joined;
    });
    world.step(5000);
    CHECK(joined > 2);
    CHECK(world.count() == 27u + static_cast<unsigned>(joined));
}

TEST_CASE("rejected input leaves a running world unchanged", "[granular][errors]")
{
    World world = with_floor(hertz_mindlin(glass(), 0.5, 0.3));
    world.add(Particle{.r = {0, 0, 0.9999 * R}, .radius = R});
    world.step(100);
    const Vec3 before = world.particles()[0].r;

    World lawless = with_floor(hertz_mindlin(glass(), 0.5, 0.3));
    lawless.add(Particle{.r = {0, 0, R}, .radius = R});
    lawless.step(10);
    lawless.add(Boundary{.material = 1});
    CHECK_THROWS_AS(lawless.step(), io::InvalidInput);
    CHECK_THROWS_AS(lawless.contacts(), io::InvalidInput);
    lawless.set_law(0, 1, hertz_mindlin(glass(), 0.5, 0.3));
    lawless.step();
    CHECK(lawless.contacts().size() == 2);

    world.add(Particle{.r = {0, 0, 50 * R}, .radius = 5 * R});
    CHECK_THROWS_AS(world.step(), io::InvalidInput);
    CHECK(world.particles()[0].r == before);
    CHECK(world.contacts().size() == 1);

    World crowded = with_floor(hertz_mindlin(glass(), 0.5, 0.3));
    crowded.add(Particle{.r = {0, 0, R}, .radius = R});
    crowded.step(10);
    crowded.add(Particle{.r = {0.5 * R, 0, R}, .radius = R});
    CHECK_THROWS_WITH(crowded.step(), Catch::Contains("particle 0 and particle 1: must not overlap"));
    CHECK_THROWS_AS(crowded.step(), io::InvalidInput);

    CHECK_THROWS_AS(world.add(Boundary{.axis = {0, 0, 2}}), io::InvalidInput);
    CHECK_THROWS_AS(world.add(Boundary{.r = {0, 0, std::nan("")}}), io::InvalidInput);
    CHECK_THROWS_AS(world.set_velocity(9, {0, 0, 0}, {0, 0, 0}), io::InvalidInput);
}

TEST_CASE("a rolling law can be set while contacts exist", "[granular]")
{
    PairLaw law = hertz_mindlin(glass(), 0.3, 0.5);
    World world = with_floor(law);
    world.add(Particle{.r = {-10 * R, 0, R}, .radius = R, .v = {0.05, 0, 0}, .omega = {0, 50, 0}});
    world.step(1000);
    const double rolls = world.particles()[0].v.x;
    CHECK(rolls == Approx(0.05).epsilon(0.01));
    law.rolling = granular::Epsd{.mu_r = 0.05f, .eta_r = 0.1f};
    world.set_law(0, 0, law);
    world.step(2000);
    // the rolling torque decelerates translation and rotation together, with the inertia 7/5 m
    CHECK(rolls - world.particles()[0].v.x == Approx(0.05 * 9.81 / 1.4 * 0.01).epsilon(0.02));
}

TEST_CASE("contacts of a restored world are those of the saved world", "[granular][checkpoint]")
{
    const auto make = [] {
        World world = with_floor(hertz_mindlin(glass(), 0.5, 0.3));
        world.set_law(0, 1, hertz_mindlin(glass(), 0.9, 0.1));
        world.add(Boundary{.r = {2 * R, 0, 0}, .axis = {-1, 0, 0}, .material = 1});
        for (int k = 0; k < 4; ++k)
            world.add(Particle{.r = {-3. * k * R, 0, R}, .radius = R, .v = {0.1, 0, 0}});
        return world;
    };
    World one = make(), other = make();
    one.step(3000);
    const std::string bytes = one.to_bytes("run");
    other.from_bytes(bytes, "run", "file");
    const auto a = one.contacts(), b = other.contacts();
    REQUIRE(a.size() == b.size());
    REQUIRE(a.size() >= 4);
    for (std::size_t k = 0; k < a.size(); ++k) CHECK((a[k].F == b[k].F && a[k].u == b[k].u));
    one.step(100), other.step(100);
    CHECK(one.to_bytes("run") == other.to_bytes("run"));
}

TEST_CASE("a restored world rebuilds its neighbour list at the same steps as the saved world",
          "[granular][checkpoint]")
{
    // The particle loses a tenth of its speed in one step, so the displacement bound must use the previous
    // speed.
    const auto make = [] {
        WorldOptions o = room();
        o.gravity = {0, 0, -1e4}, o.skin = 0.01;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.5));
        world.add(Particle{.r = {0, 0, -19 * R}, .radius = R, .v = {0, 0, 3}});
        return world;
    };
    for (long saved = 1; saved < 40; ++saved) {
        World one = make(), other = make();
        one.step(saved);
        other.from_bytes(one.to_bytes("run"), "run", "file");
        for (int k = 0; k < 30; ++k) {
            one.step(), other.step();
            REQUIRE(one.rebuilds() == other.rebuilds());
        }
    }
}

TEST_CASE("a particle and a rotating tool conserve angular momentum", "[granular][boundary]")
{
    WorldOptions o = room();
    o.gravity = {0, 0, 0}, o.h = 1e-6;
    World world(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.8, 0.3);
    law.lever = GENERATE(granular::Lever::radius, granular::Lever::contact);
    world.set_law(0, 0, law);
    Boundary tool;
    tool.shape = Boundary::Shape::sphere, tool.radius = 5 * R, tool.mass = 2e-4, tool.inertia = 2e-9;
    world.add(tool);
    world.add(Particle{.r = {2 * R, 0, 5.9 * R}, .radius = R, .v = {0.2, 0.1, -0.5}, .omega = {0, 0, 300}});
    const auto angular = [&] {
        const Particle p = world.particles()[0];
        const Boundary& b = world.boundary(0);
        const double I = 0.4 * p.mass * R * R;
        return p.mass * p.r.cross(p.v) + I * p.omega + b.mass * b.r.cross(b.v) + b.inertia * b.omega;
    };
    const Vec3 before = angular();
    world.step(2000);
    CHECK(world.contacts().empty());
    CHECK(world.boundary(0).omega.norm() > 0.1);
    // with the radii as lever arms the torques differ by the overlap times the friction
    CHECK((angular() - before).norm() <
          (law.lever == granular::Lever::contact ? 5e-6 : 2e-3) * before.norm());
    const Vec3 P = world.particles()[0].mass * world.particles()[0].v + tool.mass * world.boundary(0).v;
    const Vec3 P_0 = world.particles()[0].mass * Vec3{0.2, 0.1, -0.5};
    CHECK((P - P_0).norm() < 1e-5 * P_0.norm());
}

}  // namespace changes_test
