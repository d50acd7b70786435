// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds with clumps on all engines and from checkpoints.
#include "granular/backend/engine_impl.hpp"
#include "granular/backend/split_mix.hpp"
#include "granular/core/loops.hpp"
#include "granular/core/neighbours/neighbours_impl.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using granular::Clump;
using granular::Engine;
using granular::Random;
using granular::Scheme;
using granular::solid_clump;
using granular::Sphere;

namespace clump_engine_test {

namespace {

constexpr double R = 1e-3;

/// A back end with the scalar loops of the GPU, on the CPU
struct ScalarBackend : granular::par::Cpu {};

/// Clumps of two and three spheres and single spheres that flow out of a domain that is periodic along y
World flow(std::unique_ptr<Engine> engine, Scheme scheme)
{
    WorldOptions options;
    options.low = {-8 * R, -8 * R, -8 * R}, options.high = {8 * R, 8 * R, 8 * R};
    options.periodic = {false, true, false}, options.outflow = {false, true, false, false, false, false};
    options.gravity = {2, 0, -9.81}, options.h = 5e-6;
    options.scheme = scheme, options.orientation = true;
    World world(options, {glass()}, std::move(engine));
    PairLaw law = hertz_mindlin(glass(), 0.6, 0.4);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    world.set_law(0, 0, law);
    const auto walls = granular::open_box(options.low, options.high);
    world.add(walls[0]), world.add(walls[1]);
    const std::vector<Sphere> two = {{{0.8 * R, 0, 0}, R}, {{-0.8 * R, 0, 0}, R}},
                              three = {{{0, 0, 0}, R},
                                       {{1.2 * R, 0.3 * R, 0}, 0.8 * R},
                                       {{0, R, 0.7 * R}, 0.6 * R}};
    const int a = world.add_template(solid_clump("three", three, glass().density)),
              b = world.add_template(solid_clump("two", two, glass().density));
    Random random(8);
    for (int k = 0; k < 27; ++k) {
        const int row = k / 3 % 3, layer = k / 9;
        const Vec3 r{(-4.8 + 4.8 * (k % 3)) * R, (-4.8 + 4.8 * row) * R, (-4 + 4.8 * layer) * R};
        const Vec3 v{random.number(-1, 1), random.number(-1, 1), -0.5};
        if (k % 5 == 4)
            world.add(Particle{.r = r, .radius = R, .v = v});
        else
            world.add_clump({.shape = k % 2 == 0 ? a : b,
                             .r = r,
                             .v = v,
                             .omega = 100 * random.direction(),
                             .scale = random.number(0.8, 1.1)});
    }
    return world;
}

std::string after(World world, long steps)
{
    world.step(steps);
    return world.to_bytes("run");
}

}  // namespace

TEST_CASE("a world with clumps restored from a checkpoint continues with the same bits", "[granular][clumps]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    World reference = flow(granular::make_engine({}), scheme);
    std::size_t contacts = 0;
    for (int k = 0; k < 100; ++k) reference.step(20), contacts += reference.totals().contacts;
    std::string bytes;
    for (const long steps : {0, 1, 699, 1300}) {
        World world = flow(granular::make_engine({}), scheme);
        if (!bytes.empty()) world.from_bytes(bytes, "run", "file");
        world.step(steps);
        bytes = world.to_bytes("run");
    }
    CHECK(reference.to_bytes("run") == bytes);
    CHECK(reference.outflow().count > 0);
    CHECK(contacts > 10);
}

TEST_CASE("clumps have the same bits in packs and in scalar loops, and on a GPU",
          "[granular][clumps][engine]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    const std::string packs = after(flow(granular::make_engine({}), scheme), 2000);
    CHECK(packs == after(flow(std::make_unique<granular::EngineOn<ScalarBackend>>(), scheme), 2000));
    std::string why_not;
    if (granular::gpus(why_not).empty()) {
        WARN("skipped: " << why_not);
        return;
    }
    const std::string on_gpu = after(flow(granular::make_engine({granular::Device::cuda, 0}), scheme), 2000);
    CHECK(packs == on_gpu);
}

TEST_CASE("clumps that are added during a run leave the others as they are", "[granular][clumps]")
{
    World world = flow(granular::make_engine({}), Scheme::symplectic_euler);
    world.step(100);
    const auto before = world.clumps();
    const auto spheres = world.particles();
    const std::uint32_t id =
        world.add_clump({.shape = 1, .r = {2.4 * R, 2.4 * R, 7.2 * R}, .e = {0, 0, 1, 0}, .scale = 0.3});
    CHECK(id == spheres.size());
    CHECK(world.clumps().size() == before.size() + 1);
    world.step(0);
    const auto now = world.clumps();
    REQUIRE(now.size() == before.size() + 1);
    for (std::size_t k = 0; k < before.size(); ++k) {
        CHECK((now[k].r - before[k].r).norm() < 1e-9 * R);
        CHECK((now[k].v == before[k].v && now[k].L == before[k].L && now[k].e == before[k].e));
    }
    CHECK(now.back().id == id);
    CHECK((now.back().e == std::array{0., 0., 1., 0.}));
    const auto all = world.particles();
    for (std::size_t k = 0; k < spheres.size(); ++k) CHECK((all[k].r - spheres[k].r).norm() < 1e-9 * R);
    CHECK(all.back().clump == id);
    world.step(500);
}

}  // namespace clump_engine_test
