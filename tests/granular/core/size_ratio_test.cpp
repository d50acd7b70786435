// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbour search among particles of very different sizes, against all pairs.
#include "granular/backend/split_mix.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace hilda;
using namespace hilda::tests;

namespace size_ratio_test {

namespace {

constexpr double R = 1e-3;

double wrapped(double d, double length) { return d - length * std::round(d / length); }

}  // namespace

TEST_CASE("the contacts of particles of different sizes are those of all pairs", "[granular][neighbours]")
{
    const double ratio = GENERATE(1.5, 3., 10., 23.);
    const bool periodic = GENERATE(false, true);
    CAPTURE(ratio, periodic);
    const double size = 2 * R * (3.2 * ratio + 12);
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = {size, size, size};
    o.periodic = {periodic, periodic, false};
    o.gravity = {0, 0, 0};
    o.h = 1e-6;
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
    // Large spheres in a row, covered by small ones that overlap them by 1 %, and small ones at random
    granular::Random random(7);
    std::vector<Particle> all;
    const auto distance = [&](const Particle& a, const Particle& b) {
        Vec3 d = a.r - b.r;
        if (periodic) d.x = wrapped(d.x, size), d.y = wrapped(d.y, size);
        return d.norm();
    };
    const auto add = [&](const Particle& p) {
        const double margin = 0.1 * R;
        if (!periodic && (std::min(p.r.x, p.r.y) < margin || std::max(p.r.x, p.r.y) > size - margin)) return;
        if (p.r.z < margin || p.r.z > size - margin) return;
        for (const Particle& q : all)
            if (p.radius + q.radius - distance(p, q) > 0.02 * std::min(p.radius, q.radius)) return;
        all.push_back(p);
    };
    const double big = ratio * R;
    add(Particle{.r = {0.1 * size, 0.9 * size, 0.5 * size}, .radius = big});
    add(Particle{.r = {0.1 * size + 2 * big - 0.01 * R, 0.9 * size, 0.5 * size}, .radius = big});
    for (int k = 0; k < 400; ++k) {
        const Particle of = all[static_cast<std::size_t>(k % 2)];
        add(Particle{.r = of.r + (of.radius + 0.99 * R) * random.direction(), .radius = R});
    }
    for (int k = 0; k < 600; ++k) {
        const Vec3 r{random.number(0, size), random.number(0, size), random.number(0, size)};
        add(Particle{.r = r, .radius = random.number(0.7 * R, R)});
    }
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected, found;
    for (std::uint32_t i = 0; i < all.size(); ++i)
        for (std::uint32_t j = i + 1; j < all.size(); ++j)
            if (distance(all[i], all[j]) < all[i].radius + all[j].radius) expected.emplace(i, j);
    REQUIRE(expected.size() > 10);
    for (const Particle& p : all) world.add(p);
    world.step(1);
    const auto contacts = world.contacts();
    for (const auto& c : contacts) found.emplace(c.i, c.j);
    CHECK(found.size() == contacts.size());
    CHECK(found == expected);

    // Histories are kept over neighbour searches in which the order of the pairs changes.
    for (std::uint32_t k = 0; k < all.size(); ++k) world.set_velocity(k, {0, 0, 0}, {400, 0, 0});
    world.step(20);
    double longest = 0;
    for (const auto& c : world.contacts()) longest = std::max(longest, c.u.norm());
    const auto before = world.contacts();
    world.invalidate_neighbours();
    const auto after = world.contacts();
    REQUIRE(longest > 1e-8);
    REQUIRE(after.size() == before.size());
    for (std::size_t k = 0; k < after.size(); ++k) {
        CHECK(after[k].u == before[k].u);
        CHECK(after[k].F == before[k].F);
    }
}

TEST_CASE("a large particle does not add pairs to the others", "[granular][neighbours]")
{
    const auto pairs = [](double ratio) {
        WorldOptions o;
        o.low = {0, 0, 0}, o.high = {60 * R, 60 * R, 90 * R};
        o.h = 1e-6;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
        for (int x = 0; x < 20; ++x)
            for (int y = 0; y < 20; ++y)
                for (int z = 0; z < 10; ++z)
                    world.add(
                        Particle{.r = {(1.5 + 2.15 * x) * R, (1.5 + 2.15 * y) * R, (1.5 + 2.15 * z) * R},
                                 .radius = R});
        world.add(Particle{.r = {30 * R, 30 * R, 60 * R}, .radius = ratio * R});
        world.step(1);
        return world.candidates();
    };
    CHECK(pairs(1) == pairs(3));
    CHECK(pairs(1) == pairs(10));
    CHECK(pairs(1) == pairs(20));
}

}  // namespace size_ratio_test
