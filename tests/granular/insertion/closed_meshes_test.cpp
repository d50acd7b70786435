// SPDX-License-Identifier: GPL-3.0-or-later
// The sides of closed meshes, against the closed form of a sphere and of a box, and insertions beside them.
#include "granular/insertion/closed_meshes.hpp"
#include "granular/backend/split_mix.hpp"
#include "granular/case/case_file.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using namespace hilda::granular;

namespace closed_meshes_test {

namespace {

Boundary mesh_at(const Vec3& r, const EulerParameters<double>& p)
{
    Boundary b;
    b.shape = Boundary::Shape::mesh, b.r = r, b.p = p;
    return b;
}

World empty_world()
{
    WorldOptions o;
    o.low = {-2, -2, -2}, o.high = {2, 2, 2}, o.h = 1e-5;
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.5));
    return world;
}

}  // namespace

TEST_CASE("the side of a closed mesh is that of the solid", "[granular][insertion][mesh]")
{
    const bool inside = GENERATE(false, true);
    const auto seed = GENERATE(range(1, 9));
    hilda::granular::Random random(static_cast<std::uint64_t>(seed));
    const Vec3 at{random.number(-0.3, 0.3), random.number(-0.3, 0.3), random.number(-0.3, 0.3)};
    const EulerParameters<double> p =
        seed == 1 ? EulerParameters<double>{1, {0, 0, 0}} : turned({1, {0, 0, 0}}, 2 * random.direction());
    World world = empty_world();
    world.add(mesh_at(at, p),
              box_mesh({-0.5, -0.2, -0.3}, {0.5, 0.2, 0.3}, {}, inside, seed % 2 == 0 ? 0.1 : 0), false);
    const ClosedMeshes closed(world);
    for (int k = 0; k < 2000; ++k) {
        const Vec3 r{random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)},
            own = rotated_back(p, r - at);
        const bool is_within = std::abs(own.x) < 0.5 && std::abs(own.y) < 0.2 && std::abs(own.z) < 0.3;
        CHECK(closed.allow(r) == (is_within == inside));
    }
    // points on the planes and edges of the grid
    CHECK(closed.allow(at) == inside);
}

TEST_CASE("open and two-sided meshes have no inside", "[granular][insertion][mesh]")
{
    World world = empty_world();
    world.add(mesh_at({0, 0, 0}, {1, {0, 0, 0}}),
              box_mesh({-1, -1, -1}, {1, 1, 1}, {false, false, false, false, false, true}, false, 0), false);
    world.add(mesh_at({0, 0, 0}, {1, {0, 0, 0}}), sphere_mesh(0.5, 2), true);
    CHECK(ClosedMeshes(world).allow({0, 0, 0}));
}

TEST_CASE("nothing is inserted inside of a solid, and a late insertion says so", "[granular][insertion]")
{
    const bool container = GENERATE(false, true);
    const std::string text =
        R"({"hilda_case": 1, "domain": {"low": [0, 0, 0], "high": [1, 1, 1]}, "gravity": [0, 0, 0],
        "step": 1e-5, "end": 0.01, "materials": [{"name": "m", "density": 2500, "E": 1e7, "nu": 0.3}],
        "laws": [{"restitution": 0.5}],
        "boundaries": [{"name": "solid", "type": "mesh", "box": {"low": [0.3, 0.3, 0.3], "high": [0.7, 0.7, 0.7],
            "inside": )" +
        std::string(container ? "true" : "false") + R"(}}],
        "insert": [{"region": {"type": "box", "low": [0.1, 0.1, 0.1], "high": [0.9, 0.9, 0.9]}, "radius": 0.005,
            "count": 300, "interval": 0.001}]})";
    Case c = read_case(text, "case");
    c.world->step(1);
    const auto all = c.world->particles();
    CHECK(all.size() == 300);
    for (const Particle& p : all) {
        const auto in = [](double x) { return x > 0.3 && x < 0.7; };
        CHECK((in(p.r.x) && in(p.r.y) && in(p.r.z)) == container);
    }
    CHECK(c.insertions->all[0].shortfall(0.01, 1e-5).empty());
    CHECK(c.insertions->due_mass(0.01) == Approx(c.insertions->mass()).epsilon(1e-6));
}

TEST_CASE("an insertion that cannot keep up has a shortfall", "[granular][insertion]")
{
    const double rate = GENERATE(0.02, 20.);
    Case c = read_case(
        R"({"hilda_case": 1, "domain": {"low": [0, 0, 0], "high": [1, 1, 1]}, "gravity": [0, 0, 0],
        "step": 1e-5, "end": 0.1, "materials": [{"name": "m", "density": 2500, "E": 1e7, "nu": 0.3}],
        "laws": [{"restitution": 0.5}],
        "insert": [{"region": {"type": "box", "low": [0.1, 0.1, 0.1], "high": [0.13, 0.13, 0.13]}, "radius": 0.003,
            "mass_rate": )" +
            std::to_string(rate) + R"(, "interval": 0.001}]})",
        "case");
    c.world->step(1000);
    const bool is_behind = rate > 1;
    CHECK(c.insertions->due_mass(0.01) == Approx(rate * 0.01).epsilon(1e-3));
    CHECK(c.insertions->all[0].shortfall(c.world->t(), 1e-5).empty() == !is_behind);
}

}  // namespace closed_meshes_test
