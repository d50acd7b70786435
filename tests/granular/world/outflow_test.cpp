// SPDX-License-Identifier: GPL-3.0-or-later
// Removal of particles that leave the domain.
#include "io/error.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::RemovedParticle;

namespace outflow_test {

namespace {

constexpr double R = 1e-3, g = 9.81;
enum Side : std::uint32_t { low_x, high_x, low_y, high_y, low_z, high_z };

WorldOptions open_at(std::initializer_list<Side> sides)
{
    WorldOptions o;
    o.low = {-20 * R, -20 * R, -20 * R}, o.high = {20 * R, 20 * R, 20 * R};
    o.gravity = {0, 0, -g};
    o.h = 1e-5;
    for (const Side s : sides) o.outflow[s] = true;
    return o;
}

World with_law(const WorldOptions& o, double restitution = 0.5)
{
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), restitution, 0.5));
    return world;
}

/// Half of the skin: a particle may be outside by this distance until the neighbour search finds it.
const double late = 0.5 * WorldOptions().skin * 2 * R;

}  // namespace

TEST_CASE("particles that fall through an open side are removed at the time of free fall",
          "[granular][outflow]")
{
    World world = with_law(open_at({low_z}));
    for (int k = 0; k < 3; ++k)
        world.add(Particle{.r = {5 * k * R, 0, -5 * k * R}, .radius = R, .omega = {0, 7, 0}});
    std::vector<RemovedParticle> all;
    while (world.t() < 0.08) {
        world.step(10);
        all.insert(all.end(), world.removed().begin(), world.removed().end());
        world.clear_removed();
    }
    REQUIRE(all.size() == 3);
    CHECK(world.count() == 0);
    CHECK(world.particles().empty());
    CHECK(world.kinetic_energy() == 0);
    CHECK(world.outflow().count == 3);
    CHECK(world.outflow().mass == Approx(3 * 4.0 / 3 * M_PI * R * R * R * glass().density).epsilon(1e-6));
    for (std::uint32_t k = 0; k < 3; ++k) {
        const RemovedParticle& p = all[k];
        const double start = -5 * R * (2 - static_cast<int>(k)), fall = std::sqrt(2 * (20 * R + start) / g);
        CHECK(p.id == 2 - k);
        CHECK(p.side == low_z);
        CHECK(p.t >= fall - 2e-5);
        CHECK(p.t <= fall + late / (g * fall) + 2e-5);
        // symplectic Euler: v is exact, z has an error of g h t/2
        CHECK(p.v.z == Approx(-g * p.t).epsilon(1e-5));
        CHECK(p.r.z == Approx(start - g * p.t * p.t / 2).margin(1e-5 * g * p.t));
        CHECK(p.omega.y == Approx(7));
        CHECK(p.radius == Approx(R));
    }
    // a world without particles goes on, and takes new ones with new ids
    CHECK(world.add(Particle{.r = {0, 0, 0}, .radius = R}) == 3);
    world.step(10);
    CHECK(world.particles().at(0).id == 3);
    CHECK_THROWS_AS(world.set_velocity(0, {1, 0, 0}, {0, 0, 0}), io::InvalidInput);
    CHECK_THROWS_AS(world.set_force(2, {1, 0, 0}), io::InvalidInput);
    world.set_velocity(3, {1, 0, 0}, {0, 0, 0});
    CHECK(world.particles().at(0).v.x == Approx(1));
    world.set_velocities({3}, {{2, 0, 0}}, {{0, 0, 5}});
    world.set_velocities({3}, {{4, 0, 0}}, {});
    CHECK(world.particles().at(0).v == granular::Vec3{4, 0, 0});
    CHECK(world.particles().at(0).omega == granular::Vec3{0, 0, 5});
}

TEST_CASE("a particle that leaves through another side ends the run unless lost particles are deleted",
          "[granular][outflow]")
{
    WorldOptions options = open_at({low_z, low_x});
    for (const bool deletes : {false, true}) {
        options.delete_lost = deletes;
        World world = with_law(options);
        world.add(Particle{.r = {19 * R, 0, 0}, .radius = R, .v = {1, 0, 0}});
        world.add(Particle{.r = {-19 * R, 0, 0}, .radius = R, .v = {-1, 0, 0}});
        if (!deletes) {
            CHECK_THROWS_AS(world.step(1000), granular::ParticleLost);
            continue;
        }
        world.step(1000);
        REQUIRE(world.removed().size() == 2);
        CHECK(world.removed()[0].side == high_x);
        CHECK(world.removed()[1].side == low_x);
    }
}

TEST_CASE("the particles that remain keep their contacts when another one is removed", "[granular][outflow]")
{
    // Two grains rest on an incline by static friction; the history of their contacts holds them.
    const double angle = 0.3;
    WorldOptions o = open_at({high_x});
    o.gravity = {g * std::sin(angle), 0, -g * std::cos(angle)};
    World world = with_law(o, 0.3);
    world.add(Boundary{});
    world.set_omega_locked(true);
    world.add(Particle{.r = {10 * R, 5 * R, 5 * R}, .radius = R, .v = {0.4, 0, 0}});
    world.add(Particle{.r = {0, 0, 0.99999 * R}, .radius = R});
    world.add(Particle{.r = {-5 * R, 0, 0.99999 * R}, .radius = R});
    world.step(6000);
    REQUIRE(world.outflow().count == 1);
    for (const Particle& p : world.particles()) {
        CHECK(p.v.norm() < 1e-7);  // 0.17 m/s without friction
        CHECK(std::abs(p.r.x - (p.id == 1 ? 0 : -5 * R)) < 1e-6 * R + 1e-7);
    }
    const auto contacts = world.contacts();
    REQUIRE(contacts.size() == 2);
    const double m = 4.0 / 3 * M_PI * R * R * R * glass().density;
    for (const auto& c : contacts) CHECK(-c.F.x == Approx(m * g * std::sin(angle)).epsilon(1e-4));
}

TEST_CASE("a world that is saved while particles leave continues with the same bytes", "[granular][outflow]")
{
    const auto fresh = [&] {
        WorldOptions o = open_at({low_z, high_y});
        o.delete_lost = true;
        World world = with_law(o);
        for (int i = -2; i <= 2; ++i)
            for (int j = -2; j <= 2; ++j)
                world.add(Particle{.r = {2.1 * i * R, 2.1 * j * R, 0.3 * i * j * R},
                                   .radius = R,
                                   .v = {0.2 * j, 0.1 * i, 0}});
        world.set_force(7, {1e-5, 0, 0});
        return world;
    };
    World whole = fresh();
    std::vector<std::string> saved;
    for (int k = 0; k < 12; ++k) {
        whole.step(700);
        saved.push_back(whole.to_bytes("run"));
    }
    REQUIRE(whole.outflow().count > 5);
    for (int from : {4, 7, 9}) {
        World world = fresh();
        world.from_bytes(saved[from], "run", "file");
        for (int k = from + 1; k < 12; ++k) {
            world.step(700);
            CHECK(world.to_bytes("run") == saved[k]);
        }
        CHECK(world.removed().size() == whole.removed().size());
    }
}

}  // namespace outflow_test
