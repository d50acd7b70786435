// SPDX-License-Identifier: GPL-3.0-or-later
// Stacks of three spheres: critical mass of the upper sphere.                        Fang (2022), Sec. 7.1.4
#include "granular/validations/three_spheres.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using granular::collapse_height;
using granular::Stack;
using granular::StackRun;

namespace {

constexpr double R = 0.15;

/// Final height of the upper sphere over R, in double precision
double height(const Stack& s, double mass)
{
    WorldOptions o;
    o.h = 1e-5;
    PairLaw law = hertz_mindlin({"sphere", 1000, 2e6, 0.3}, 0.4, s.mu);
    law.rolling =
        granular::ConstantTorque{.mu_r = static_cast<float>(s.mu_r), .slow = 1e-4f, .half_radius = 1};
    granular::DoubleWorld world(o, law);
    world.boundary.emplace_back();
    Particle p;
    p.radius = R, p.mass = 1;
    for (const double side : {-1., 1.}) {
        p.r = {side * R * (1 + s.gap / 2), 0, R};
        world.particle.push_back(p);
    }
    world.step(50000);
    const double half = world.particle[1].r.x, z = world.particle[1].r.z;
    p.mass = mass, p.r = {0, 0, z + std::sqrt(4 * R * R - half * half)};
    world.particle.push_back(p);
    world.step(200000);
    return world.particle[2].r.z / R;
}

}  // namespace

TEST_CASE("the critical mass of a stack is that in double precision (long)", "[granular][stacking]")
{
    const std::vector<Stack> stacks = {{0.3, 0.158, 0.10}, {0.3, 0.158, 0.40}};
    const std::vector<double> mass = critical_masses(stacks, StackRun{});
    for (std::size_t k = 0; k < stacks.size(); ++k) {
        INFO("mu_r = " << stacks[k].mu_r << ": " << mass[k] << " kg");
        CHECK(height(stacks[k], mass[k] + 0.01) < collapse_height);
        CHECK(height(stacks[k], mass[k] - 0.02) > collapse_height);
        // the upper sphere is released suddenly, so the critical mass is below the static limit
        CHECK(mass[k] == Approx(static_limit(stacks[k], 0.5, 0.5)).epsilon(0.07));
    }
}

TEST_CASE("a stack computed with others falls as a single stack does", "[granular][stacking][replica]")
{
    const std::vector<Stack> stacks = {{0.2, 0.16, 0.07}, {0.3, 0.16, 0.13}, {0.4, 0.2, 0.3}};
    const std::vector<double> mass = {1, 0.5, 2};
    const StackRun run{.settle = 0.05, .watch = 0.1};
    const std::vector<double> together = heights(stacks, mass, run);
    for (std::size_t k = 0; k < stacks.size(); ++k)
        CHECK(heights({stacks[k]}, {mass[k]}, run)[0] == together[k]);
}

TEST_CASE("without rolling friction a stack collapses unless friction locks it", "[granular][stacking]")
{
    // the lower spheres roll away where tan(θ/2) > μ, with sin θ = (1 + gap/2)/2: 0.30
    const std::vector<double> z =
        heights({{0.2, 0.158, 0}, {0.2, 0.5, 0}}, {0.2, 0.2}, StackRun{.h = 5e-5, .settle = 0.1, .watch = 2});
    CHECK(z[0] < collapse_height);
    CHECK(z[1] > collapse_height);
    CHECK(granular::static_limit({0.2, 0.158, 0}, 0.5, 0.5) == 0);
}
