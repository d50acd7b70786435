// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts through several periodic images: a short box against the same box repeated along its short axes.
#include "granular/backend/engine_impl.hpp"
#include "granular/backend/split_mix.hpp"
#include "granular/core/loops.hpp"
#include "granular/core/neighbours/neighbours_impl.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace hilda;
using namespace hilda::tests;
using granular::Engine;

namespace images_test {

namespace {

constexpr double R = 1e-3;

/// A back end with the scalar loops of the GPU, on the CPU
struct ScalarBackend : granular::par::Cpu {};

/// A box above a plane that is periodic along x and y
struct Box {
    double depth_x, depth_y;  ///< [m]
    double largest;           ///< radius [m]
};

/// Distance of the closest images, also of a particle from itself [m]
double nearest_image(const Box& box, const Vec3& d, bool own)
{
    double least = 1;
    for (int a = -2; a <= 2; ++a)
        for (int b = -2; b <= 2; ++b)
            if (!own || a != 0 || b != 0)
                least = std::min(least, (d + Vec3{a * box.depth_x, b * box.depth_y, 0}).norm());
    return least;
}

/// Particles of which some overlap by up to 3 % of a radius, the first two through two images
std::vector<Particle> particles(const Box& box)
{
    granular::Random random(5);
    std::vector<Particle> all;
    const auto add = [&](const Particle& p) {
        for (const Particle& q : all)
            if (nearest_image(box, p.r - q.r, false) < p.radius + q.radius - 0.03 * R) return;
        all.push_back(p);
    };
    const double half = 0.5 * box.depth_y, apart = 1.99 * R;
    add({.r = {0.1 * R, 0.1 * R, 4 * R}, .radius = R});
    if (half < apart)
        add({.r = {0.1 * R, 0.1 * R + half, 4 * R + std::sqrt(apart * apart - half * half)}, .radius = R});
    for (int k = 0; k < 3000; ++k)
        add({.r = {random.number(0, box.depth_x), random.number(0, box.depth_y), random.number(R, 12 * R)},
             .radius = random.number(0.7 * R, k < 20 ? box.largest : R)});
    for (Particle& p : all) {
        p.v = 0.1 * random.direction() + Vec3{0, 2, 0};  // they cross the sides of the box
        p.omega = 50 * random.direction();
    }
    return all;
}

/// A world with `times` copies of the particles along both axes
World repeated(const Box& box, int times_x, int times_y, const std::vector<Particle>& of,
               std::unique_ptr<Engine> engine = nullptr)
{
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = {times_x * box.depth_x, times_y * box.depth_y, 40 * R};
    o.periodic = {true, true, false};
    o.h = 2e-6, o.skin = 0.05;
    World world = engine ? World(o, {glass()}, std::move(engine)) : World(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.5, 0.5);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    world.set_law(0, 0, law);
    granular::Boundary floor;
    world.add(floor);
    for (int a = 0; a < times_x; ++a)
        for (int b = 0; b < times_y; ++b)
            for (Particle p : of) {
                p.r = p.r + Vec3{a * box.depth_x, b * box.depth_y, 0};
                world.add(p);
            }
    return world;
}

double wrapped(double d, double length) { return d - length * std::round(d / length); }

}  // namespace

TEST_CASE("grains in a short periodic box have the motion of a box that is repeated",
          "[granular][neighbours][images]")
{
    // 1.5, 1.1 and 2.5 diameters; along both axes; large grains in a box of 1.2 of their diameters
    const Box box = GENERATE(Box{16 * R, 3 * R, R}, Box{16 * R, 2.2 * R, R}, Box{16 * R, 5 * R, R},
                             Box{3 * R, 2.5 * R, R}, Box{16 * R, 6 * R, 2.4 * R});
    CAPTURE(box.depth_x / R, box.depth_y / R);
    const std::vector<Particle> all = particles(box);
    REQUIRE(all.size() > 5);
    const int times_x = box.depth_x < 10 * R ? 4 : 1, times_y = 4;
    World world = repeated(box, 1, 1, all), large = repeated(box, times_x, times_y, all);
    world.step(1), large.step(1);
    const std::size_t contacts = world.contacts().size();
    CHECK(contacts > all.size() / 10);
    CHECK(large.contacts().size() == contacts * static_cast<std::size_t>(times_x * times_y));
    const auto worst = [&] {
        double of_r = 0, of_v = 0;
        const std::vector<Particle> of_world = world.particles(), of_large = large.particles();
        for (std::uint32_t k = 0; k < all.size(); ++k) {
            const Particle &p = of_world[k], &q = of_large[k];
            const Vec3 d = p.r - q.r;
            of_r = std::max(of_r, Vec3{wrapped(d.x, box.depth_x), wrapped(d.y, box.depth_y), d.z}.norm());
            of_v = std::max({of_v, (p.v - q.v).norm(), R * (p.omega - q.omega).norm()});
        }
        return std::pair(of_r, of_v);
    };
    // one step: the loads differ by rounding errors of single precision
    CHECK(worst().first < 1e-8 * R);
    CHECK(worst().second < 1e-6);
    // Histories are kept over searches in which particles pass to the other side of the box.
    const long rebuilds = world.rebuilds();
    world.step(1000), large.step(1000);
    CHECK(world.rebuilds() > rebuilds + 5);
    CHECK(worst().first < 1e-4 * R);
    CHECK(worst().second < 1e-3);
}

TEST_CASE("the back ends and a resumed run agree in a short periodic box", "[granular][neighbours][images]")
{
    const Box box{3 * R, 2.5 * R, R};
    const std::vector<Particle> all = particles(box);
    World packs = repeated(box, 1, 1, all),
          scalar = repeated(box, 1, 1, all, std::make_unique<granular::EngineOn<ScalarBackend>>());
    packs.step(300), scalar.step(300);
    const std::string saved = packs.to_bytes("");
    CHECK(saved == scalar.to_bytes(""));
    World resumed = repeated(box, 1, 1, {});
    resumed.from_bytes(saved, "", "checkpoint");
    packs.step(300), resumed.step(300);
    CHECK(packs.to_bytes("") == resumed.to_bytes(""));
}

TEST_CASE("particles inserted in a short periodic box leave the contacts of the others unchanged",
          "[granular][neighbours][images]")
{
    const Box box{16 * R, 3 * R, R};
    const std::vector<Particle> all = particles(box);
    World world = repeated(box, 1, 1, all);
    world.step(300);
    const auto before = world.contacts();
    world.add(Particle{.r = {R, R, 30 * R}, .radius = 1.2 * R});  // another grid
    world.step(0);
    const auto after = world.contacts();
    REQUIRE(after.size() == before.size());
    for (std::size_t n = 0; n < after.size(); ++n) {
        CHECK((after[n].i == before[n].i && after[n].j == before[n].j));
        CHECK((after[n].u - before[n].u).norm() <= 1e-6 * before[n].u.norm());
    }
}

}  // namespace images_test
