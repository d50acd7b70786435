// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of grains with meshes, against planes and analytic spheres.
#include "granular/backend/split_mix.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "granular/world/world_impl.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <omp.h>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::EulerParameters;
using granular::TriangleMesh;

namespace {

constexpr double R = 0.01, h = 1e-5;

WorldOptions options()
{
    return {.low = {-0.5, -0.5, -0.5}, .high = {0.5, 0.5, 0.5}, .gravity = {0, 0, -9.81}, .h = h};
}

World empty_world(const WorldOptions& o = options())
{
    World world(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.8, 0.4);
    world.set_law(0, 0, law);
    return world;
}

Boundary mesh_boundary(const Vec3& r = {0, 0, 0}, const EulerParameters<double>& p = {1, {0, 0, 0}})
{
    Boundary b;
    b.shape = Boundary::Shape::mesh, b.r = r, b.p = p;
    return b;
}

Particle ball(const Vec3& r, const Vec3& v = {0, 0, 0}, const Vec3& omega = {0, 0, 0})
{
    Particle p;
    p.radius = R, p.r = r, p.v = v, p.omega = omega;
    return p;
}

/// The one particle of a world after some steps
Particle after(World& world, long steps)
{
    world.step(steps);
    return world.particles()[0];
}

}  // namespace

TEST_CASE("a ball that slides and rolls over a mesh moves as over the plane", "[granular][mesh]")
{
    const double edge = GENERATE(1., 0.1, 0.013);  // 2, 200 and 12 000 triangles
    World plane = empty_world(), mesh = empty_world();
    plane.add(Boundary{});
    mesh.add(mesh_boundary(), granular::plate_mesh(1, 1, edge));
    const Particle start = ball({-0.3, -0.12, 0.999 * R}, {1, 0.37, 0}, {0, 3, 0});
    plane.add(start), mesh.add(start);
    const Particle expected = after(plane, 40000), found = after(mesh, 40000);
    const Vec3 way = expected.r - start.r;
    REQUIRE(way.norm() > 0.3);
    CHECK((found.r - expected.r).norm() < 1e-4 * way.norm());
    CHECK((found.omega - expected.omega).norm() < 1e-4 * expected.omega.norm());
    REQUIRE(mesh.contacts().size() == 1);
    const Vec3 u = plane.contacts()[0].u;
    CHECK((mesh.contacts()[0].u - u).norm() < 0.01 * u.norm());
}

TEST_CASE("a ball rebounds from a mesh as from the plane, wherever it strikes", "[granular][mesh]")
{
    World plane = empty_world();
    plane.add(Boundary{});
    plane.add(ball({0, 0, 1.001 * R}, {0.2, 0, -0.5}, {0, 0, 5}));
    const Particle expected = after(plane, 2000);
    REQUIRE(expected.v.z > 0.2);
    for (const double x : {0., 0.05, 0.0125, 0.031}) {  // on a vertex, on edges, inside of a triangle
        World mesh = empty_world();
        mesh.add(mesh_boundary(), granular::plate_mesh(1, 1, 0.1));
        mesh.add(ball({x, 0, 1.001 * R}, {0.2, 0, -0.5}, {0, 0, 5}));
        const Particle found = after(mesh, 2000);
        CHECK((found.v - expected.v).norm() < 1e-6);
        CHECK((found.omega - expected.omega).norm() < 1e-4);
    }
}

TEST_CASE("the motion of grains on a mesh does not depend on its pose", "[granular][mesh]")
{
    granular::Random random(5);
    const Vec3 a = random.direction();
    const EulerParameters<double> p{std::cos(0.7), std::sin(0.7) * a};
    WorldOptions o = options();
    o.gravity = {0, 0, 0};
    World one = empty_world(o), other = empty_world(o);
    const TriangleMesh sphere = granular::sphere_mesh(0.05, 2);
    one.add(mesh_boundary(), sphere);
    other.add(mesh_boundary({0.1, -0.05, 0.02}, p), sphere);
    const Vec3 r{0.061, 0.004, 0.003}, v{-1, 0.3, 0.1};
    one.add(ball(r, v));
    other.add(ball(Vec3{0.1, -0.05, 0.02} + rotated(p, r), rotated(p, v)));
    const Particle first = after(one, 3000), second = after(other, 3000);
    REQUIRE(first.v.x > 0);
    CHECK((rotated(p, first.v) - second.v).norm() < 1e-5);
    CHECK((rotated(p, first.omega) - second.omega).norm() < 1e-3);
}

TEST_CASE("impacts on spheres of triangles converge to those on a sphere at second order", "[granular][mesh]")
{
    WorldOptions o = options();
    o.gravity = {0, 0, 0};
    // The gap between the sphere and its triangles; the mean over many places
    const auto error = [&](int divisions) {
        granular::Random random(3);
        World world = empty_world(o);
        world.add(mesh_boundary(), granular::sphere_mesh(0.1, divisions));
        double sum = 0;
        for (int k = 0; k < 200; ++k) {
            const Vec3 at = (0.1 + 0.98 * R) * random.direction();
            const granular::Surfaces surfaces{world.all_boundaries().data(), world.all_meshes().view()};
            double least = 1e300;
            for (std::uint32_t t = 0; t < world.all_meshes().triangle.size(); ++t)
                least = std::min(
                    least, surfaces.nearest(granular::Surfaces::first_triangle + t, at, 2 * R).distance);
            sum += least - 0.98 * R;
        }
        return sum / 200;
    };
    const double coarse = error(2), fine = error(3), finer = error(4);
    CHECK(std::log2(coarse / fine) == Approx(2).margin(0.1));
    CHECK(std::log2(fine / finer) == Approx(2).margin(0.1));
}

TEST_CASE("a moving mesh carries a ball as a moving plane does", "[granular][mesh]")
{
    World plane = empty_world(), mesh = empty_world();
    Boundary moving;
    moving.v = {0.2, 0, 0.1}, moving.omega = {0, 0, 2};
    plane.add(moving);
    Boundary b = mesh_boundary();
    b.v = moving.v, b.omega = moving.omega;
    mesh.add(b, granular::plate_mesh(0.8, 0.8, 0.07));
    const Particle start = ball({0.1, 0.05, 0.999 * R});
    plane.add(start), mesh.add(start);
    const Particle expected = after(plane, 30000), found = after(mesh, 30000);
    CHECK((found.r - expected.r).norm() < 1e-5);
    CHECK((found.v - expected.v).norm() < 1e-3);
}

TEST_CASE("a ball in a tube of triangles keeps its energy", "[granular][mesh]")
{
    const int segments = GENERATE(48, 400, 2000);
    WorldOptions o = options();
    // slides to and fro across the generators, with an overlap up to 1 % of the radius
    o.gravity = {-9.81, 0, 0};
    World tube(o, {glass()});
    tube.set_law(0, 0, hertz_mindlin(glass(), 1, 0));
    tube.add(mesh_boundary(), granular::lathe_mesh({{0.03, -0.1}, {0.03, 0.1}}, segments));
    const double a = 0.9, far = 0.03 * std::cos(M_PI / segments) - 1.0005 * R;
    tube.add(ball({-far * std::cos(a), far * std::sin(a), 0.0013}));
    const auto energy = [&] {
        const Particle p = tube.particles()[0];
        return p.mass * (0.5 * p.v.dot(p.v) + 9.81 * p.r.x);
    };
    const double start = energy(), scale = 0.009 * 9.81 * tube.particles()[0].mass;
    double most = 0;
    for (int k = 0; k < 300; ++k) {
        tube.step(100);
        CHECK(tube.contacts().size() <= 1);
        most = std::max(most, energy() - start);
    }
    CHECK(most < 0.01 * scale);
}

TEST_CASE("the contacts at an instant have the friction of the step, also across edges", "[granular][mesh]")
{
    World plane = empty_world(), mesh = empty_world();
    plane.add(Boundary{});
    mesh.add(mesh_boundary(), granular::plate_mesh(1, 1, 0.013));
    const Particle start = ball({-0.3, -0.12, 0.999 * R}, {1, 0.37, 0});
    plane.add(start), mesh.add(start);
    plane.step(1000), mesh.step(1000);
    for (int k = 0; k < 400; ++k) {  // crosses several edges
        plane.step(10), mesh.step(10);
        const Vec3 expected = plane.wrench(0).F, found = mesh.wrench(0).F;
        REQUIRE((found - expected).norm() < 0.02 * expected.norm());
    }
}

TEST_CASE("a bed in a box of triangles has the contacts of a box of planes", "[granular][mesh]")
{
    WorldOptions o = options();
    World planes = empty_world(o), mesh = empty_world(o);
    const Vec3 low{-0.07, -0.07, -0.07}, high{0.07, 0.07, 0.07};
    for (const Boundary& b : granular::open_box(low, high)) planes.add(b);
    mesh.add(mesh_boundary(),
             granular::box_mesh(low, high, {false, false, false, false, false, true}, true, 0.03));
    granular::Random random(1);
    for (int x = 0; x < 6; ++x)
        for (int y = 0; y < 6; ++y)
            for (int z = 0; z < 5; ++z) {
                const auto at = [&](int k) { return -0.055 + 0.0215 * k + random.number(-0.0007, 0.0007); };
                const Particle p = ball({at(x), at(y), at(z)});
                planes.add(p), mesh.add(p);
            }
    planes.step(70000), mesh.step(70000);
    const auto lower = [](const World& world) {
        double z = 0;
        for (const Particle& p : world.particles()) z += p.r.z;
        return z / 180;
    };
    // Chaotic motion; the heaps are the same in the mean.
    CHECK(lower(mesh) == Approx(lower(planes)).margin(0.05 * R));
    double weight = 0;
    for (const Particle& p : mesh.particles()) weight += p.mass * 9.81;
    CHECK(mesh.wrench(0).F.z == Approx(-weight).epsilon(0.02));
    for (const Particle& p : mesh.particles()) CHECK(p.r.z > low.z);
}

TEST_CASE("a world with a mesh has the same bits for any number of threads and after a restart",
          "[granular][mesh]")
{
    const auto make = [] {
        World world = empty_world();
        Boundary drum = mesh_boundary();
        drum.omega = {0, 6, 0};
        world.add(drum, granular::box_mesh({-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}, {}, true, 0.025));
        granular::Random random(1);
        for (int k = 0; k < 100; ++k) {
            const int row = k / 5 % 5, layer = k / 25;
            world.add(ball({-0.045 + 0.0215 * (k % 5) + random.number(-0.0005, 0.0005), -0.045 + 0.0215 * row,
                            -0.045 + 0.0215 * layer}));
        }
        return world;
    };
    World one = make();
    one.step(3000);
    const std::string saved = one.to_bytes("run");
    one.step(3000);
    const std::string expected = one.to_bytes("run");
    omp_set_num_threads(3);
    World other = make();
    other.step(3000);
    CHECK(other.to_bytes("run") == saved);
    World restored = make();
    restored.from_bytes(saved, "run", "file");
    restored.step(3000);
    omp_set_num_threads(1);
    CHECK(restored.to_bytes("run") == expected);
}

TEST_CASE("a checkpoint of a world with other triangles is refused with the boundary", "[granular][mesh]")
{
    const auto make = [](double edge) {
        World world = empty_world();
        world.add(Boundary{});
        world.add(mesh_boundary(), granular::plate_mesh(1, 1, 0.5));
        world.add(mesh_boundary({0, 0, 0.1}), granular::plate_mesh(1, 1, edge));
        world.add(ball({0, 0, 2 * R}));
        return world;
    };
    const std::string saved = make(0.25).to_bytes("run");
    World same = make(0.25), other = make(0.2);
    same.from_bytes(saved, "run", "file");
    CHECK_THROWS_WITH(
        other.from_bytes(saved, "run", "file"),
        "file: the triangles of the mesh of boundary 2 have changed since the checkpoint was written");
}

TEST_CASE("meshes can be added after the first step", "[granular][mesh]")
{
    World world = empty_world(), other = empty_world();
    const auto add = [](World& w, double z) {
        w.add(mesh_boundary({0, 0, z}), granular::plate_mesh(0.5, 0.5, 0.1));
    };
    add(world, -0.2), add(other, -0.2);
    world.add(ball({0.01, 0, 1.1 * R})), other.add(ball({0.01, 0, 1.1 * R}));
    world.step(1);  // the engine shares the triangles now
    add(world, 0), add(other, 0);
    world.step(1999), other.step(2000);
    CHECK(world.particles()[0].r == other.particles()[0].r);
    CHECK(world.particles()[0].v.z > -0.2);
}

TEST_CASE("a mesh is added with its triangles", "[granular][mesh]")
{
    World world = empty_world();
    CHECK_THROWS_WITH(world.add(mesh_boundary()),
                      "boundary: a mesh must be added with its triangles, got none");
    CHECK_THROWS_WITH(world.add(Boundary{}, granular::plate_mesh(1, 1, 0)),
                      "boundary 0: the shape of a boundary with triangles must be a mesh, got 0");
    CHECK_THROWS_WITH(world.add(mesh_boundary(), {}), "boundary 0: a mesh must have a triangle, got none");
    CHECK(world.all_boundaries().empty());
}
