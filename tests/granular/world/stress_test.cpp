// SPDX-License-Identifier: GPL-3.0-or-later
// Love-Weber stress of loaded particles.
#include "granular/world/output.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace hilda;
using namespace hilda::tests;
using namespace hilda::granular;

namespace stress_test {

namespace {

constexpr double R = 0.01, side = 2.5 * R, A = side * side;
constexpr int high = 6;

Material rubber() { return {"rubber", 1000, 1e6, 0.3}; }

/// A column of spheres on a floor
World column(double g, const PairLaw& law)
{
    WorldOptions o;
    o.low = {-0.1, -0.1, -0.05}, o.high = {0.1, 0.1, 0.2};
    o.gravity = {0, 0, -g}, o.h = 1e-5;
    World world(o, {rubber()});
    world.set_law(0, 0, law);
    world.add(Boundary{});
    for (int k = 0; k < high; ++k) world.add(Particle{.r = {0, 0, (2 * k + 1) * R}, .radius = R});
    return world;
}

void only_upright(const std::array<double, 9>& sigma, double within)
{
    for (int k = 0; k < 8; ++k) CHECK(std::abs(sigma[k]) < within);
}

}  // namespace

TEST_CASE("the stress of a compressed column is the load over the area", "[granular][stress]")
{
    constexpr double F = 0.5;
    World world = column(0, hertz_mindlin(rubber(), 0.1));
    Boundary plate;
    plate.axis = {0, 0, -1}, plate.r = {0, 0, 2 * high * R};
    plate.mass = 0.01, plate.free = {false, false, true}, plate.F = {0, 0, -F};
    world.add(plate);
    world.step(200000);
    CHECK(world.wrench(0).F.z == Approx(-F).epsilon(1e-4));
    const double H = world.boundary(1).r.z;
    CHECK(H < 2 * high * R - 1e-4);
    const auto sigma = stress(world, world.contacts(), A * H);
    CHECK(sigma[8] == Approx(F / A).epsilon(1e-4));
    only_upright(sigma, 1e-4 * F / A);
}

TEST_CASE("the mean stress of a column under gravity is half the weight over the area", "[granular][stress]")
{
    World world = column(9.81, hertz_mindlin(rubber(), 0.1));
    world.step(80000);
    const double weight = high * 9.81 * world.particles()[0].mass;
    CHECK(world.wrench(0).F.z == Approx(-weight).epsilon(1e-4));
    // each contact carries the weight above: R (N + 2 (N - 1) + ... + 2) w = R N² w, less the overlaps
    const auto sigma = stress(world, world.contacts(), A * 2 * high * R);
    double overlaps = 0;
    for (const ContactRecord& c : world.contacts()) overlaps += c.delta * c.F.norm();
    CHECK(sigma[8] == Approx((high * R * weight - overlaps) / (A * 2 * high * R)).epsilon(1e-4));
    CHECK(overlaps < 0.05 * high * R * weight);
    only_upright(sigma, 1e-4 * weight / A);
}

TEST_CASE("the stress is symmetric without friction, and at rest with friction (long)", "[granular][stress]")
{
    const double mu = GENERATE(0., 0.4);
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> shift(-0.1 * R, 0.1 * R);
    WorldOptions o;
    constexpr double width = 6.6 * R;
    o.low = {-R, -R, -R}, o.high = {width + R, width + R, 10 * R}, o.h = 2e-5;
    World world(o, {rubber()});
    world.set_law(0, 0, hertz_mindlin(rubber(), 0.1, mu));
    for (const Boundary& b : open_box({0, 0, 0}, {width, width, 0})) world.add(b);
    for (int k = 0; k < 27; ++k) {
        const int column = k % 3, row = k / 3 % 3, layer = k / 9;
        world.add(Particle{.r = {(1.1 + 2.2 * column) * R + shift(engine),
                                 (1.1 + 2.2 * row) * R + shift(engine), (1.1 + 2.2 * layer) * R},
                           .radius = R});
    }
    world.step(50000);
    const auto sigma = stress(world, world.contacts(), width * width * 6 * R);
    const double p = sigma[8];
    // half of the weight over the area, less the effect of particles that sink between others
    const double weight = 27 * 9.81 * world.particles()[0].mass;
    CHECK(p > 0.3 * weight / (width * width));
    CHECK(p < 0.55 * weight / (width * width));
    for (const auto& [a, b] : {std::pair(1, 3), std::pair(2, 6), std::pair(5, 7)})
        CHECK(std::abs(sigma[a] - sigma[b]) < (mu > 0 ? 1e-3 : 1e-6) * p);
    for (const int k : {0, 4}) CHECK(sigma[k] > 0);
    CHECK(world.contacts().size() > 40);
}

}  // namespace stress_test
