// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of grains at rest, of averages over time, and their independence of the number of threads.
#include "granular/fields/field_input.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <omp.h>
#include <cmath>
#include <cstring>
#include <random>

using namespace hilda::granular;
using namespace hilda::tests;

namespace column_test {

namespace {

constexpr double R = 0.01, side = 7 * R, A = side * side, g = 9.81;
constexpr int high = 8;

/// A column of grains at rest on a floor at z = 0, or on a fixed grain below z = 0
World column(bool on_fixed_grain)
{
    WorldOptions o;
    o.low = {-side / 2, -side / 2, -0.05}, o.high = {side / 2, side / 2, 0.25},
    o.periodic = {true, true, false};
    o.gravity = {0, 0, -g}, o.h = 1e-5;
    const Material rubber = {"rubber", 1000, 1e6, 0.3};
    World world(o, {rubber});
    world.set_law(0, 0, hertz_mindlin(rubber, 0.1));
    if (on_fixed_grain)
        world.add(Particle{.r = {0, 0, -R}, .radius = R, .fixed = true});
    else
        world.add(Boundary{});
    for (int k = 0; k < high; ++k) world.add(Particle{.r = {0, 0, (2 * k + 1) * R}, .radius = R});
    world.step(200000);
    return world;
}

}  // namespace

TEST_CASE("the vertical stress in a column at rest is the weight above over the area", "[granular][fields]")
{
    const bool on_fixed_grain = GENERATE(false, true);
    const World world = column(on_fixed_grain);
    const FieldInput in = field_input(world, world.contacts(), 0);
    REQUIRE(in.particles.size() == high);
    const double weight = high * in.particles[0].mass * g;
    for (const Kernel& kernel : {Kernel{Kernel::Type::gaussian, R}, Kernel{Kernel::Type::lucy, 2.5 * R}}) {
        double error[2] = {};
        for (const int fine : {0, 1}) {
            FieldGrid profile{.low = {-side / 2, -side / 2, -0.05},
                              .high = {side / 2, side / 2, 0.25},
                              .cells = {1, 1, fine != 0 ? 240 : 120},
                              .period = {side, side, 0}};
            FieldSums sums(profile, kernel);
            sums.add(in);
            // Of a cell, the half of its own weight is above its centre.
            double above = 0;
            for (std::size_t k = profile.count(); k-- > 0;) {
                const FieldValues f = sums.values(k);
                const double own = profile.edge(2) * (f.density * g - f.boundary_force.z);
                error[fine] = std::max(error[fine], std::abs(f.contact_stress[8] - above - own / 2));
                above += own;
                for (std::size_t a = 0; a < 8; ++a) CHECK(std::abs(f.contact_stress[a]) < 1e-6 * weight / A);
            }
            CHECK(std::abs(above) < 1e-5 * weight / A);  // the floor carries the weight
        }
        INFO(error[0] * A / weight << " " << error[1] * A / weight);
        CHECK(error[1] < 1e-3 * weight / A);
        // Second order in the length of the cells; of first order at the jump of the cut Gaussian
        CHECK(std::log2(error[0] / error[1]) > (kernel.type == Kernel::Type::lucy ? 1.8 : 0.9));
    }
}

TEST_CASE("mean fields over instants have the fluctuations about the mean velocity", "[granular][fields]")
{
    const FieldGrid grid{.low = {-1, -1, -1}, .high = {1, 1, 1}};
    FieldSums sums(grid, {Kernel::Type::gaussian, 0.1});
    for (const double v : {1., 3.})
        sums.add({.particles = {{.r = {0, 0, 0}, .v = {v, 0, 0}, .mass = 2, .volume = 0.5}}, .contacts = {}});
    const FieldValues f = sums.values(0);
    CHECK(f.density == Approx(0.25));
    CHECK(f.volume_fraction == Approx(0.0625));
    CHECK(f.velocity.x == Approx(2));
    CHECK(f.kinetic_stress[0] == Approx(0.25 * 1));  // ρ times the variance of v
    sums.reset();
    CHECK(sums.values(0).density == 0);
    CHECK(sums.values(0).velocity.norm() == 0);
}

TEST_CASE("fields have the same bits for any number of threads", "[granular][fields]")
{
    FieldInput in;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(0, 1);
    const auto vector = [&] { return Vec3{any(random), any(random), any(random)}; };
    for (int k = 0; k < 1500; ++k) {
        in.particles.push_back({vector(), vector(), any(random), any(random)});
        in.contacts.push_back({vector(), 0.05 * vector(), vector(), k % 7 == 0});
    }
    const FieldGrid grid{.low = {0, 0, 0}, .high = {1, 1, 1}, .cells = {6, 9, 5}, .period = {1, 0, 1}};
    for (const Kernel::Type type : {Kernel::Type::gaussian, Kernel::Type::lucy}) {
        std::vector<FieldValues> first;
        for (const int threads : {1, 2, 5}) {
            omp_set_num_threads(threads);
            FieldSums sums(grid, {type, 0.06});
            sums.add(in);
            std::vector<FieldValues> all;
            for (std::size_t k = 0; k < grid.count(); ++k) all.push_back(sums.values(k));
            if (threads == 1) first = all;
            CHECK(std::memcmp(all.data(), first.data(), all.size() * sizeof all[0]) == 0);
        }
        omp_set_num_threads(1);
    }
}

}  // namespace column_test
