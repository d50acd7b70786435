// SPDX-License-Identifier: GPL-3.0-or-later
// The same world on several engines: packs of the CPU, scalar loops of the GPU executed on the CPU, and a GPU
// if there is one. All results are bitwise equal.
#include "granular/backend/engine_impl.hpp"
#include "granular/backend/instruction_set.hpp"
#include "granular/core/loops.hpp"
#include "granular/core/neighbours/neighbours_impl.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <random>

#include <omp.h>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Engine;
using granular::Scheme;

namespace {

constexpr double R = 1e-3;

/// A back end with the scalar loops of the GPU, on the CPU
struct ScalarBackend : granular::par::Cpu {};

Material steel() { return {"steel", 7800, 2e8, 0.3}; }

/// Two materials with laws of all types, in a box that is periodic along x, with a falling plate, to which a
/// torus is fixed, and a rotating drum with a post
std::string run(std::unique_ptr<Engine> engine, Scheme scheme)
{
    WorldOptions o;
    o.low = {0, -8 * R, -8 * R}, o.high = {12 * R, 8 * R, 20 * R};
    o.periodic = {true, false, false};
    o.h = 5e-6, o.scheme = scheme, o.orientation = scheme != Scheme::chung;
    World world(o, {glass(), steel()}, std::move(engine));
    PairLaw law = hertz_mindlin(glass(), 0.5, 0.4);
    law.tangential = granular::MindlinDeresiewicz{
        .spring = granular::TangentialSpring::of_materials(glass(), glass(), 0.5), .mu = 0.4f};
    world.set_law(0, 0, law);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    law.cohesion = granular::ConstantCohesion{.F_c = 1e-5f};
    law.normal = granular::WaltonBraun{.k_1 = 800, .k_2 = 2000, .S = 100};
    law.tangential = granular::Mindlin{.spring = {.k_t = 500, .c = 0, .gamma_t = 20}, .cap = {0.4f, 0.4f}};
    world.set_law(0, 1, law);
    law = hertz_mindlin(steel(), 0.8, 0.2);
    law.tangential = granular::MindlinIncremental{.spring = {.k_t = 5e7f, .c = 0.2f}, .cap = {0.3f, 0.2f}};
    law.rolling = granular::PseudoForce{.mu_r = 0.05f, .k_r = 1, .eta_r = 0.1f};
    law.lever = granular::Lever::contact;
    world.set_law(1, 1, law);
    Boundary drum;
    drum.shape = Boundary::Shape::cylinder, drum.axis = {1, 0, 0}, drum.inside = 1, drum.radius = 6.5 * R;
    drum.omega = {5, 0, 0};
    world.add(drum);
    Boundary plate;
    plate.axis = {0, 0, -1}, plate.r = {0, 0, 8 * R}, plate.mass = 1e-3, plate.material = 1;
    world.add(plate);
    Boundary post = granular::frustum({6 * R, 0, -6.4 * R}, {0, 0, 1}, 2 * R, 2 * R, R), ring;
    post.material = 1;
    ring.shape = Boundary::Shape::torus, ring.r = {6 * R, 0, 7.2 * R}, ring.radius = 0.7 * R;
    ring.second_radius = 2 * R, ring.material = 1;
    world.add(post), world.add(ring);
    world.set_part(2, 0), world.set_part(3, 1);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int k = 0; k < 75; ++k) {
        Particle p;
        p.radius = R * (0.8 + 0.15 * in(random)), p.material = k % 2;
        const int column = k % 5, row = k / 5 % 3, layer = k / 15;
        p.r = 2.1 * R * Vec3{column + 0.5, row - 1., 0.9 * layer - 1.4};
        p.v = {0.3 * in(random), 0.3 * in(random), 0.3 * in(random)};
        p.omega = {40 * in(random), 40 * in(random), 40 * in(random)};
        world.add(p);
    }
    world.before_each_step([](World& w) { w.set_force(7, {1e-5 * std::sin(1e3 * w.t()), 0, 0}); });
    world.step(10000);
    CHECK(world.rebuilds() > 5);
    CHECK(world.contacts().size() > 15);
    return world.to_bytes("");
}

/// n³ particles in a dense packing with a small skin, so that the neighbour list is rebuilt often
std::string dense_packing(std::unique_ptr<Engine> engine, int n)
{
    WorldOptions o;
    const double width = 2.05 * R * n;
    o.low = {0, 0, -R}, o.high = {width, width, width + 20 * R};
    o.periodic = {true, true, false};
    o.h = 2e-5, o.skin = 0.02;
    World world(o, {glass()}, std::move(engine));
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.4));
    world.add(Boundary{});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int k = 0; k < n * n * n; ++k)
        world.add(Particle{.r = 2.05 * R * Vec3{k % n + 0.5, k / n % n + 0.5, k / (n * n) % n + 0.5},
                           .radius = R,
                           .v = {0.3 * in(random), 0.3 * in(random), 0.3 * in(random)}});
    world.step(300);
    CHECK(world.rebuilds() > 30);
    return world.to_bytes("");
}

/// Grains of two materials in a rotating drum of triangles, with a two-sided paddle, a fixed ball and a
/// falling prism: contacts with faces, edges and vertices of several meshes, at rest and in motion
std::string mesh_drum(std::unique_ptr<Engine> engine, Scheme scheme)
{
    WorldOptions o;
    o.low = {-0.02, -0.02, -0.01}, o.high = {0.02, 0.02, 0.03};
    o.h = 5e-6, o.scheme = scheme;
    World world(o, {glass(), steel()}, std::move(engine));
    PairLaw law = hertz_mindlin(glass(), 0.5, 0.4);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    world.set_law(0, 0, law);
    law.normal = granular::WaltonBraun{.k_1 = 800, .k_2 = 2000, .S = 100};
    world.set_law(0, 1, law);
    law = hertz_mindlin(steel(), 0.8, 0.2);
    law.lever = granular::Lever::contact;
    world.set_law(1, 1, law);
    const auto boundary = [](const Vec3& r, const Vec3& v, const Vec3& omega, int material) {
        Boundary b;
        b.shape = Boundary::Shape::mesh, b.r = r, b.v = v, b.omega = omega, b.material = material;
        return b;
    };
    // The floor and the wall of the drum are divided, so that grains rest on edges and vertices too.
    world.add(boundary({0, 0, 0}, {0, 0, 0}, {0, 0, 12}, 1),
              granular::lathe_mesh({{0, 0}, {4 * R, 0}, {8 * R, 0}, {8 * R, 5 * R}, {8 * R, 25 * R}}, 24));
    Boundary paddle = boundary({0, 0, 0.006}, {0, 0, 0}, {0, 0, -20}, 0);
    paddle.p = {std::sqrt(0.5), {0, std::sqrt(0.5), 0}};
    world.add(paddle, granular::plate_mesh(0.01, 0.004, 0.0015), true);
    world.add(boundary({0, 0, 0.001}, {0, 0, 0}, {0, 0, 0}, 1), granular::sphere_mesh(2 * R, 1));
    Boundary prism = boundary({-0.001, -0.001, 0.022}, {0, 0, -0.5}, {0, 0, 0}, 1);
    prism.mass = 1e-3, prism.inertia = 1e-9;
    world.add(prism, granular::extrude_mesh({{0, 0}, {0.003, 0}, {0.0005, 0.0025}}, 0.002));
    std::mt19937 random(17);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int k = 0; k < 6 * 6 * 7; ++k) {
        const Vec3 r = 2.1 * R * Vec3{k % 6 - 2.5, k / 6 % 6 - 2.5, k / 36 + 2.};
        if (r.x * r.x + r.y * r.y > 42 * R * R || std::abs(r.x) < R) continue;
        world.add(Particle{.r = r,
                           .radius = R * (0.9 + 0.1 * in(random)),
                           .material = k % 2,
                           .v = {0.2 * in(random), 0.2 * in(random), -0.3}});
    }
    world.step(8000);
    CHECK(world.rebuilds() > 20);
    std::array<int, 4> of{};
    for (const granular::ContactRecord& c : world.contacts())
        if (c.boundary) ++of[c.j];
    CAPTURE(of);
    CHECK(of[0] > 20);
    CHECK(of[0] + of[1] + of[2] + of[3] > 30);
    return world.to_bytes("");
}

struct Packing {
    double spacing = 2.05 * R;
    double size_step = 0.04;  ///< of the three sizes, over the largest radius
    int fixed_every = 101;    ///< one of so many particles is fixed
    double speed = 0.3;       ///< largest component of the velocities [m/s]
};
/// Several blocks and ranges of the one-pass step: a dense packing of n³ particles with several radii and
/// laws, periodic along two axes, with fixed particles
std::string mixed_packing(std::unique_ptr<Engine> engine, int n, Scheme scheme, const Packing& packing = {})
{
    WorldOptions o;
    const double width = packing.spacing * n;
    o.low = {0, 0, -R}, o.high = {width, width, width + 20 * R};
    o.periodic = {true, true, false};
    o.h = 1e-5, o.skin = 0.05, o.scheme = scheme;
    World world(o, {glass(), steel()}, std::move(engine));
    PairLaw law = hertz_mindlin(glass(), 0.5, 0.4);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    world.set_law(0, 0, law);
    law.normal = granular::WaltonBraun{.k_1 = 800, .k_2 = 2000, .S = 100};
    law.tangential = granular::MindlinDeresiewicz{.spring = {.k_t = 500, .c = 0, .gamma_t = 20}, .mu = 0.4f};
    world.set_law(0, 1, law);
    law = hertz_mindlin(steel(), 0.8, 0.2);
    law.lever = granular::Lever::contact;
    world.set_law(1, 1, law);
    world.add(Boundary{});
    world.set_watch(true, 0);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int k = 0; k < n * n * n; ++k)
        world.add(Particle{.r = packing.spacing * Vec3{k % n + 0.5, k / n % n + 0.5, k / (n * n) % n + 0.5},
                           .radius = R * (1 - packing.size_step * (k % 3)),
                           .material = k % 2,
                           .v = packing.speed * Vec3{in(random), in(random), in(random)},
                           .fixed = k % packing.fixed_every == 0});
    world.step(150);
    CHECK(world.rebuilds() > (packing.speed < 0.3 ? 0 : 5));
    return world.to_bytes("");
}

}  // namespace

TEST_CASE("one-pass steps give the bits of the scalar loops for any number of threads", "[granular][engine]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    const int most = omp_get_max_threads();
    omp_set_num_threads(1);
    const std::string expected =
        mixed_packing(std::make_unique<granular::EngineOn<ScalarBackend>>(), 14, scheme);
    for (const int threads : {1, 2, 3, 5}) {
        CAPTURE(threads);
        omp_set_num_threads(threads);
        CHECK(mixed_packing(granular::make_engine({}), 14, scheme) == expected);
    }
    omp_set_num_threads(most);
}

// With a watch the pairs with fixed particles are evaluated before the pass, but the loads of a particle are
// added in the order of its pairs.
TEST_CASE("pairs with fixed particles in a pressed packing do not change the order of the sums",
          "[granular][engine]")
{
    const Packing pressed{.spacing = 1.955 * R, .size_step = 0.002, .fixed_every = 5, .speed = 0.02};
    const int most = omp_get_max_threads();
    const std::string expected = mixed_packing(std::make_unique<granular::EngineOn<ScalarBackend>>(), 12,
                                               Scheme::symplectic_euler, pressed);
    for (const int threads : {1, 2, 3, 5}) {
        CAPTURE(threads);
        omp_set_num_threads(threads);
        CHECK(mixed_packing(granular::make_engine({}), 12, Scheme::symplectic_euler, pressed) == expected);
    }
    omp_set_num_threads(most);
}

TEST_CASE("packs and scalar loops give bitwise equal results", "[granular][engine]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    const std::string packs = run(granular::make_engine({}), scheme);
    CHECK(packs == run(std::make_unique<granular::EngineOn<ScalarBackend>>(), scheme));
    if (scheme == Scheme::symplectic_euler)
        for (const int n : {3, 4, 9}) {  // as many cells along a periodic axis, of which 3 are the least
            CAPTURE(n);
            CHECK(dense_packing(granular::make_engine({}), n) ==
                  dense_packing(std::make_unique<granular::EngineOn<ScalarBackend>>(), n));
        }
}

TEST_CASE("the loops of every instruction set give the bits of the scalar loops", "[granular][engine][mesh]")
{
    const Scheme scheme = Scheme::velocity_verlet;
    const std::string packing =
                          mixed_packing(std::make_unique<granular::EngineOn<ScalarBackend>>(), 9, scheme),
                      drum = mesh_drum(std::make_unique<granular::EngineOn<ScalarBackend>>(), scheme),
                      before = granular::instruction_set().name;
    int available = 0;
    for (const granular::InstructionSet& set : granular::instruction_sets()) {
        if (!set.available()) continue;
        CAPTURE(set.name);
        ++available;
        granular::choose_instruction_set(set.name);
        CHECK(granular::instruction_set().name == std::string(set.name));
        CHECK(mixed_packing(granular::make_engine({}), 9, scheme) == packing);
        CHECK(mesh_drum(granular::make_engine({}), scheme) == drum);
    }
    granular::choose_instruction_set(before);
    CHECK(available > 0);
}

TEST_CASE("an unknown instruction set is refused with the list of those of the build", "[granular][engine]")
{
    const std::string first = granular::instruction_sets().front().name;
    CHECK_THROWS_WITH(granular::choose_instruction_set("avx9"),
                      Catch::StartsWith("--isa: must be " + first) && Catch::EndsWith(", got 'avx9'"));
}

// The CPU skips the search for the closest feature where it cannot have changed; the scalar loops do not.
TEST_CASE("contacts with triangles have the bits of a search in each step", "[granular][engine][mesh]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    const int most = omp_get_max_threads();
    const std::string expected = mesh_drum(std::make_unique<granular::EngineOn<ScalarBackend>>(), scheme);
    for (const int threads : {1, 3}) {
        CAPTURE(threads);
        omp_set_num_threads(threads);
        CHECK(mesh_drum(granular::make_engine({}), scheme) == expected);
    }
    omp_set_num_threads(most);
}

TEST_CASE("a GPU and the CPU give bitwise equal results; without a GPU the reason is reported",
          "[granular][engine]")
{
    std::string why;
    const auto names = granular::gpus(why);
    if (names.empty()) {
        CHECK(!why.empty());
        CHECK_THROWS_AS(granular::make_engine({granular::Device::cuda, 0}), granular::DeviceError);
        return;
    }
    for (const Scheme scheme : {Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung})
        CHECK(run(granular::make_engine({}), scheme) ==
              run(granular::make_engine({granular::Device::cuda, 0}), scheme));
    CHECK(mesh_drum(granular::make_engine({}), Scheme::symplectic_euler) ==
          mesh_drum(granular::make_engine({granular::Device::cuda, 0}), Scheme::symplectic_euler));
    CHECK(dense_packing(granular::make_engine({}), 70) ==
          dense_packing(granular::make_engine({granular::Device::cuda, 0}), 70));
    CHECK_THROWS_AS(granular::make_engine({granular::Device::cuda, static_cast<int>(names.size())}),
                    granular::DeviceError);
}
