// SPDX-License-Identifier: GPL-3.0-or-later
// Domains that are much larger than the bed of particles in them.
#include "granular/backend/split_mix.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::ContactRecord;

namespace sparse_domain_test {

namespace {

constexpr double R = 1e-3;

WorldOptions domain(const Vec3& high)
{
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = high;
    o.h = 5e-6;
    return o;
}

/// Some spheres that fall on a plane, in 20 replicas, after 300 steps
std::vector<Particle> fallen(const Vec3& high, std::uint16_t replicas)
{
    World world(domain(high), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
    Boundary floor;
    floor.r = {0, 0, 1e-3};
    world.add(floor);
    granular::Random random(3);
    for (std::uint16_t replica = 0; replica < replicas; ++replica)
        for (int k = 0; k < 60; ++k) {
            const int layer = k / 16;
            Particle p{.r = {(2 + k % 4 * 2.05) * R, (2 + k / 4 % 4 * 2.05) * R, (2.02 + layer * 2.05) * R},
                       .radius = R};
            p.v = {random.number(-0.3, 0.3), random.number(-0.3, 0.3), -0.1};
            p.replica = replica;
            world.add(p);
        }
    world.step(300);
    return world.particles();
}

}  // namespace

TEST_CASE("a motion does not depend on the size of the domain, to the last bit", "[granular][neighbours]")
{
    const auto replicas = static_cast<std::uint16_t>(GENERATE(1, 20));
    const std::vector<Particle> tight = fallen({0.014, 0.014, 0.014}, replicas);
    // Between 3e6 and 1e8 cells in a replica, and up to 9100 cells along one axis
    for (const Vec3& high : {Vec3{0.4, 0.5, 0.3}, {20, 0.02, 0.02}, {0.014, 0.02, 20}, {1, 1, 0.5}}) {
        CAPTURE(high.x, high.y, high.z, replicas);
        const std::vector<Particle> loose = fallen(high, replicas);
        bool same = true;
        for (std::size_t k = 0; k < tight.size(); ++k)
            same = same && loose[k].r == tight[k].r && loose[k].v == tight[k].v &&
                   loose[k].omega == tight[k].omega;
        CHECK(same);
    }
}

TEST_CASE("in a domain of more than 2^31 cells contacts are found with a coarser length unit",
          "[granular][neighbours]")
{
    const double size = 14;  // 6400 diameters and skins along each axis
    World world(domain({size, size, size}), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
    const double overlap = 1e-3 * R;
    std::vector<Particle> pairs;
    for (const double x : {0.1, 3.3, size - 0.1})
        for (const double z : {0.2, size - 0.2}) {
            world.add(Particle{.r = {x, 0.5 * size, z}, .radius = R});
            world.add(Particle{.r = {x + 2 * R - overlap, 0.5 * size, z}, .radius = R});
        }
    world.step(0);
    const std::vector<ContactRecord> contacts = world.contacts();
    REQUIRE(contacts.size() == 6);
    for (const ContactRecord& c : contacts) CHECK(c.delta == Approx(overlap).epsilon(1e-4));
}

TEST_CASE("a domain that is too large for the particles is rejected", "[granular][neighbours]")
{
    World world(domain({100, 100, 100}), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
    world.add(Particle{.r = {1, 1, 1}, .radius = R});
    CHECK_THROWS_WITH(world.step(), Catch::Contains("must not have more than 2^31 cells"));
}

}  // namespace sparse_domain_test
