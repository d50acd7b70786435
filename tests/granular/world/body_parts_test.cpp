// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid bodies of several boundaries: motion of the parts, their loads, momentum; tools that leave the
// domain.
#include "granular/core/rigid_body.hpp"

#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::rotated;
using granular::Scheme;
using granular::turned;
using Shape = Boundary::Shape;

namespace body_parts_test {

namespace {

WorldOptions room(double h, Scheme scheme = Scheme::symplectic_euler)
{
    WorldOptions o;
    o.low = {-0.02, -0.02, -0.02}, o.high = {0.02, 0.02, 0.02};
    o.h = h, o.scheme = scheme, o.gravity = {0, 0, 0};
    return o;
}

World glass_world(const WorldOptions& o)
{
    World world(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.6, 0.4);
    law.lever = granular::Lever::contact;
    world.set_law(0, 0, law);
    return world;
}

Boundary ball(const Vec3& r, double radius)
{
    Boundary b;
    b.shape = Shape::sphere, b.r = r, b.radius = radius;
    return b;
}

/// The triangles of a mesh that `which` selects
template <class Which>
granular::TriangleMesh part_of(const granular::TriangleMesh& mesh, const Which& which)
{
    granular::TriangleMesh part{mesh.vertex, {}};
    for (const auto& t : mesh.triangle)
        if (which(t)) part.triangle.push_back(t);
    return part;
}

}  // namespace

TEST_CASE("two spheres that are parts of a third move as a free rigid body", "[granular][tool]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    // symmetric top: A(t) = exp(t L/J_1) A_0 exp(t (1 - J_3/J_1) ω̄_3 e_3)
    const double J1 = 4e-6, J3 = 1.5e-6, t = 0.1;
    const Vec3 omega{20, -10, 30}, v{0.01, 0.02, -0.01}, X{1e-3, 2e-3, 6e-3};
    const double spin = (1 - J3 / J1) * omega.z;
    const Vec3 L{J1 * omega.x, J1 * omega.y, J3 * omega.z};
    const auto expected = turned(turned({1, {0, 0, 0}}, {0, 0, t * spin}), (t / J1) * L);
    const auto error = [&, s = scheme](int steps) {
        World world = glass_world(room(t / steps, s));
        Boundary body = ball({0, 0, 0}, 2e-3);
        body.mass = 0.1, body.inertia = std::array{J1, J1, J3, 0., 0., 0.}, body.omega = omega, body.v = v;
        world.add(ball(X, 1e-3)), world.add(body), world.add(ball(-X, 1e-3));
        world.set_part(0, 1), world.set_part(2, 1);
        world.step(steps);
        const Boundary &first = world.boundary(0), &second = world.boundary(2), &b = world.boundary(1);
        CHECK((first.v - (b.v + b.omega.cross(first.r - b.r))).norm() < 1e-15);
        CHECK(((first.r - b.r) + (second.r - b.r)).norm() < 1e-16);
        CHECK(first.omega == b.omega);
        return (first.r - (t * v + rotated(expected, X))).norm();
    };
    const double coarse = error(200), fine = error(400);
    INFO(coarse << ' ' << fine);
    CHECK(std::log2(coarse / fine) == Approx(2).margin(0.05));
    CHECK(fine < 2e-6);
}

TEST_CASE("a cube of two parts moves among particles as the cube of one mesh", "[granular][tool][mesh]")
{
    const auto run = [&](bool split) {
        World world = glass_world(room(1e-6));
        const granular::TriangleMesh cube =
            granular::box_mesh({-4e-3, -4e-3, -4e-3}, {4e-3, 4e-3, 4e-3}, {}, false, 0);
        const auto is_upper = [&](const std::array<std::uint32_t, 3>& t) {
            return std::all_of(t.begin(), t.end(), [&](auto v) { return cube.vertex[v].z > 0; });
        };
        Boundary body;
        body.mass = 2e-3, body.inertia = 3e-8, body.omega = {10, -5, 3}, body.v = {0, 0, 0.1};
        body.p = turned({1, {0, 0, 0}}, {0.05, -0.1, 0.2});
        Boundary mesh;
        mesh.shape = Shape::mesh, mesh.p = body.p;
        if (split) {
            body.shape = Shape::none;
            const int top = world.add(mesh, part_of(cube, is_upper)), number = world.add(body),
                      rest = world.add(mesh, part_of(cube, [&](const auto&t) { return !is_upper(t); }));
            world.set_part(top, number), world.set_part(rest, number);
        } else {
            body.shape = Shape::mesh;
            world.add(body, cube);
        }
        // on the faces +z and -x
        for (const double x : {-1.5e-3, 1.5e-3})
            world.add(Particle{.r = {x, 1e-3, 6.3e-3}, .radius = 1e-3, .v = {0, 0.1, -0.6}});
        world.add(Particle{.r = {-6e-3, 0, 0.3e-3}, .radius = 1e-3, .v = {0.5, 0, 0}});
        world.step(3000);
        const Boundary b = world.boundary(split ? 1 : 0);
        const granular::Wrench on = world.wrench(split ? 1 : 0);
        return std::tuple{b, world.particles(), on};
    };
    const auto [a, of_a, on_a] = run(false);
    const auto [b, of_b, on_b] = run(true);
    CHECK((a.v - Vec3{0, 0, 0.1}).norm() > 0.01);
    CHECK((a.r - b.r).norm() < 1e-12);
    CHECK((a.v - b.v).norm() < 1e-9);
    CHECK((a.omega - b.omega).norm() < 1e-6);
    for (std::size_t k = 0; k < of_a.size(); ++k) {
        CHECK(of_a[k].v.norm() > 0);
        CHECK((of_a[k].v - of_b[k].v).norm() < 1e-7);
    }
}

TEST_CASE("particles and a dumb-bell of boundaries conserve momentum and angular momentum",
          "[granular][tool]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    World world = glass_world(room(1e-6, scheme));
    Boundary rod = granular::frustum({-4e-3, 0, 0}, {1, 0, 0}, 8e-3, 1e-3, 1e-3);
    rod.mass = 0, rod.v = {0, 0, 0};
    Boundary body;
    body.shape = Shape::none, body.mass = 1e-3, body.inertia = std::array{2e-9, 2e-8, 2e-8, 0., 0., 0.};
    body.omega = {0, 20, 10};
    world.add(ball({-5e-3, 0, 0}, 2e-3)), world.add(rod), world.add(ball({5e-3, 0, 0}, 2e-3));
    const int number = world.add(body);
    for (int k = 0; k < 3; ++k) world.set_part(k, number);
    for (int k = 0; k < 5; ++k)
        world.add(Particle{.r = {2.4e-3 * (k - 2), 0.2e-3 * k, 4.5e-3},
                           .radius = 1e-3,
                           .v = {0.05, -0.02 * k, -0.7},
                           .omega = {0, 0, 100. * k}});
    struct Momenta {
        Vec3 P, L;
    };
    const auto momenta = [&] {
        const Boundary& b = world.boundary(number);
        Momenta m{b.mass * b.v, angular_momentum(b) + b.mass * b.r.cross(b.v)};
        for (const Particle& p : world.particles()) {
            m.P += p.mass * p.v;
            m.L += p.mass * p.r.cross(p.v) + 0.4 * p.mass * p.radius * p.radius * p.omega;
        }
        return m;
    };
    const Momenta before = momenta();
    int loaded = 0;
    for (int k = 0; k < 80; ++k) {
        world.step(100);
        const auto totals = world.totals();
        granular::Wrench sum;
        for (int part = 0; part < 3; ++part) {
            const granular::Wrench& on = totals.on_boundary[static_cast<std::size_t>(part)];
            sum.F += on.F;
            sum.T += on.T + (world.boundary(part).r - world.boundary(number).r).cross(on.F);
        }
        const granular::Wrench& on = totals.on_boundary[static_cast<std::size_t>(number)];
        CHECK((on.F - sum.F).norm() <= 1e-14 * (1 + on.F.norm()));
        CHECK((on.T - sum.T).norm() <= 1e-15);
        loaded += on.F.norm() > 0;
    }
    const Momenta after = momenta();
    CHECK(loaded > 2);
    CHECK(world.boundary(number).v.norm() > 0.02);
    INFO((after.P - before.P).norm() / before.P.norm()
         << ' ' << (after.L - before.L).norm() / before.L.norm());
    CHECK((after.P - before.P).norm() < 1e-6 * before.P.norm());
    CHECK((after.L - before.L).norm() < 2e-6 * before.L.norm());
}

TEST_CASE("the parts of a body with a prescribed motion move with it", "[granular][boundary]")
{
    World world = glass_world(room(1e-5));
    Boundary drum;
    drum.shape = Shape::cylinder, drum.inside = 1, drum.radius = 0.01, drum.axis = {0, 1, 0};
    drum.omega = {0, 3, 0}, drum.v = {0.01, 0, 0};
    Boundary vane;
    vane.shape = Shape::disk, vane.r = {5e-3, 0, 0}, vane.axis = {0, 0, 1}, vane.radius = 3e-3;
    world.add(drum), world.add(vane);
    world.set_part(1, 0);
    world.step(20000);
    const Vec3 moved = world.boundary(0).r;
    CHECK(moved.x == Approx(0.002).epsilon(1e-12));
    const double angle = 3 * 0.2;
    CHECK((world.boundary(1).r - moved - 5e-3 * Vec3{std::cos(angle), 0, -std::sin(angle)}).norm() < 1e-15);
    CHECK((world.boundary(1).axis - Vec3{std::sin(angle), 0, std::cos(angle)}).norm() < 1e-12);
    CHECK((world.boundary(1).v - velocity(world.boundary(0), world.boundary(1).r)).norm() < 1e-15);
}

TEST_CASE("the axis of a tumbling frustum follows its orientation", "[granular][tool][shapes]")
{
    World world = glass_world(room(1e-5));
    Boundary tool = granular::frustum({0, 0, 0}, {0, 0.6, 0.8}, 4e-3, 1e-3, 2e-3);
    tool.from -= 2.4e-3, tool.to -= 2.4e-3;
    tool.mass = 1e-3, tool.inertia = std::array{2e-9, 1.6e-9, 1.4e-9, 0., 2e-10, 0.};
    tool.omega = {200, -100, 150};
    world.add(tool);
    world.add(Particle{.r = {0.015, 0, 0}, .radius = 1e-3});
    world.step(5000);
    const Boundary& b = world.boundary(0);
    CHECK((b.axis - Vec3{0, 0.6, 0.8}).norm() > 0.1);
    CHECK((b.axis - rotated(b.p, Vec3{0, 0.6, 0.8})).norm() < 1e-12);
}

TEST_CASE("a part that cannot be one is refused", "[granular][tool]")
{
    World world = glass_world(room(1e-5));
    Boundary heavy = ball({0, 0, 0}, 1e-3);
    heavy.mass = 1;
    const int a = world.add(ball({0, 0, 0}, 1e-3)), b = world.add(heavy),
              c = world.add(ball({0, 0, 0}, 1e-3));
    CHECK_THROWS_WITH(world.set_part(a, a), "boundary 0: must not be a part of itself, got 0");
    CHECK_THROWS_WITH(world.set_part(a, 7), "part: no boundary has this number, got 7");
    CHECK_THROWS_WITH(world.set_part(b, a), Catch::Contains("must have no mass"));
    world.set_part(a, b);
    CHECK_THROWS_WITH(world.set_part(a, c), Catch::Contains("is a part already"));
    CHECK_THROWS_WITH(world.set_part(c, a), Catch::Contains("that is not a part itself"));
    CHECK_THROWS_WITH(world.set_part(b, c), Catch::Contains("has parts itself"));
    world.step(1);
    CHECK_THROWS_WITH(world.set_part(c, b), Catch::Contains("before the first step"));
}

TEST_CASE("a tool that falls out of the domain ends the run, one that leaves it elsewhere gives a warning",
          "[granular][tool]")
{
    const auto [gravity, v] =
        GENERATE(table<Vec3, Vec3>({{{0, 0, -9.81}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 1}}}));
    WorldOptions o = room(1e-4);
    o.gravity = gravity;
    World world = glass_world(o);
    Boundary tool = ball({0.001, 0.002, 0}, 1e-3);
    tool.mass = 1, tool.v = v;
    world.add(Boundary{.r = {0, 0, -0.01}});
    world.add(tool);
    world.add(Particle{.r = {0.01, 0.01, -0.009}, .radius = 1e-3});
    world.set_boundary_names({"floor", "shoe"});
    if (v.z > 0) {
        world.step(300);
        CHECK(world.watch().warnings == granular::WatchRecord::left);
        CHECK_THAT(watch_warning(world.watch(), granular::WatchRecord::left, {"floor", "shoe"}),
                   Catch::Contains("boundary 'shoe' has left the domain at (0.001, 0.002, 0.02") &&
                       Catch::Contains("at t = 0.02"));
        return;
    }
    // z = -g t²/2 is below -0.02 m after 0.0639 s
    CHECK_THROWS_WITH(world.step(1000),
                      Catch::Contains("boundary 'shoe' has left the domain at (0.001, 0.002, -0.02") &&
                          Catch::Contains("at t = 0.063"));
}

TEST_CASE("a tool may start outside of the domain, and a plane may slide in itself", "[granular][tool]")
{
    WorldOptions o = room(1e-4);
    World world = glass_world(o);
    Boundary tool = ball({0, 0, 0.03}, 1e-3), plate;
    tool.mass = 1, tool.v = {0, 0, 0.1};
    plate.mass = 1, plate.r = {0.0199, 0, -0.01}, plate.v = {1, 0, 0};
    world.add(tool), world.add(plate);
    world.add(Particle{.r = {0, 0, 0}, .radius = 1e-3});
    world.step(100);
    CHECK(world.boundary(1).r.x > 0.02);
    CHECK(world.watch().warnings == 0);
}

}  // namespace body_parts_test
