// SPDX-License-Identifier: GPL-3.0-or-later
// Grains that come to rest.
#include "granular/validations/settling.hpp"

#include "io/error.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::granular;

namespace {

/// One grain 5 cm above a floor, which it reaches after about 0.1 s
World falling()
{
    const Material glass{"glass", 2500, 1e7, 0.24};
    WorldOptions o;
    o.low = {-0.1, -0.1, -0.01}, o.high = {0.1, 0.1, 0.2};
    o.gravity = {0, 0, -9.81}, o.h = 2e-5;
    World world(o, {glass});
    world.set_law(0, 0, hertz_mindlin(glass, 0.1, 0.5));
    world.add(Boundary{});
    Particle p;
    p.radius = 5e-3, p.r = {0, 0, 0.055};
    world.add(p);
    world.step(0);
    return world;
}

const Settling settling{.what = "the grain", .interval = 100, .longest = 1, .energy = 1e-4};

}  // namespace

TEST_CASE("grains settle for the shortest time after the call, not after the start of the world",
          "[granular][settling]")
{
    World world = falling();
    settle(world, settling, [](double) {});
    CHECK(world.t() > 0.1);
    const double first = world.t();
    CHECK(world.particles().front().r.z == Approx(5e-3).epsilon(0.01));
    Settling again = settling;
    again.shortest = 0.05;
    double share = 0;
    settle(world, again, [&](double now) { share = now; });  // the grain is at rest
    CHECK(world.t() - first > 0.05);
    CHECK(world.t() - first < 0.06);
    CHECK(share == Approx(world.t() - first));  // of the longest time, 1 s
}

TEST_CASE("the longest time of settling counts from the call", "[granular][settling]")
{
    World world = falling();
    settle(world, settling, [](double) {});
    const double first = world.t();
    Settling of = settling;
    of.longest = 0.15, of.energy = 0;
    double share = 0;
    CHECK_THROWS_AS(settle(world, of, [&](double now) { share = now; }), io::NumericalFailure);
    CHECK(world.t() - first > 0.15);
    CHECK(world.t() - first < 0.16);
    CHECK(share == 1);
}
