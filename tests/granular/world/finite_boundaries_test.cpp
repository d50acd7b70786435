// SPDX-License-Identifier: GPL-3.0-or-later
// Particles on finite boundaries: frusta, disks and tori, among infinite ones and meshes of the same shape.
#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::frustum;
using granular::Nearest;
using granular::Scheme;
using Shape = Boundary::Shape;

namespace finite_boundaries_test {

namespace {

constexpr double R = 1e-3;

WorldOptions room(double h)
{
    WorldOptions o;
    o.low = {-0.02, -0.02, -0.02}, o.high = {0.02, 0.02, 0.02};
    o.h = h;
    return o;
}

}  // namespace

TEST_CASE("a finite cylinder acts as the infinite one beside its ends", "[granular][shapes]")
{
    const bool inside = GENERATE(false, true);
    const Vec3 axis = (1 / 3.) * Vec3{1, 2, 2}, across = (1 / std::sqrt(5.)) * Vec3{2, -1, 0};
    const auto end = [&](bool finite) {
        WorldOptions o = room(2e-6);
        o.gravity = {0, 0, 0};
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.7, 0.4));
        Boundary b = frustum(-4e-3 * axis, axis, 9e-3, 3e-3, 3e-3);
        if (!finite) b.shape = Shape::cylinder;
        b.inside = inside ? 1 : 0, b.flags = granular::open_first_end | granular::open_second_end;
        world.add(b);
        world.add(Particle{.r = (3e-3 + (inside ? -1.2 : 1.2) * R) * across,
                           .radius = R,
                           .v = (inside ? 0.3 : -0.3) * across + 0.1 * axis,
                           .omega = {50, 30, -20}});
        world.step(2000);
        return world.particles()[0];
    };
    const Particle a = end(true), b = end(false);
    CHECK(a.v.dot(across) * (inside ? -1 : 1) > 0.1);
    CHECK((a.v - b.v).norm() <= 1e-14);
    CHECK((a.r - b.r).norm() <= 1e-17);
    CHECK((a.omega - b.omega).norm() <= 1e-11);
}

TEST_CASE("a ball bounces elastically from faces, edges and the tip of finite solids", "[granular][shapes]")
{
    struct Start {
        Boundary b;
        Vec3 r, v;
        double margin =
            2e-5;  ///< R* changes, and the energy with it, where the contact slides along a curved side
    };
    Boundary disk, torus;
    disk.shape = Shape::disk, disk.radius = 3e-3;
    torus.shape = Shape::torus, torus.radius = 1e-3, torus.second_radius = 4e-3;
    const Boundary cone = frustum({0, 0, -4e-3}, {0, 0, 1}, 4e-3, 4e-3, 0),
                   rod = frustum({0, 0, -4e-3}, {0, 0, 1}, 4e-3, 3e-3, 3e-3);
    const std::vector<Start> all = {
        {rod, {1e-3, 0, 1.1 * R}, {0, 0, -0.5}},          {rod, {3.3e-3, 0, 1.1 * R}, {0, 0, -0.5}},
        {rod, {3.3e-3, 0, 1.1 * R}, {-0.1, 0.2, -0.5}},   {cone, {0.2e-3, 0.1e-3, 1.1 * R}, {0, 0, -0.5}},
        {cone, {2e-3, 1e-3, 0.1e-3}, {0, 0, -0.5}, 1e-3}, {cone, {3.3e-3, 0, -1.7e-3}, {-0.4, 0, -0.4}},
        {disk, {3.5e-3, 0, 1.1 * R}, {0, 0, -0.5}},       {torus, {0, 4e-3, 2.1 * R}, {0, 0, -0.5}},
        {torus, {4.5e-3, 0, 2.1 * R}, {0, 0, -0.5}, 1e-3}};
    for (std::size_t k = 0; k < all.size(); ++k) {
        WorldOptions o = room(5e-7);
        o.gravity = {0, 0, 0}, o.scheme = Scheme::velocity_verlet;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 1));
        world.add(all[k].b);
        world.add(Particle{.r = all[k].r, .radius = R, .v = all[k].v});
        const double before = world.kinetic_energy();
        double least = before;
        for (int n = 0; n < 200; ++n) {
            world.step(20);
            least = std::min(least, world.kinetic_energy());
        }
        INFO("start " << k << ", relative change " << world.kinetic_energy() / before - 1);
        CHECK(least < 0.98 * before);
        CHECK(world.contacts().empty());
        CHECK(std::abs(world.kinetic_energy() / before - 1) < all[k].margin);
    }
}

TEST_CASE("a ball rolls from a face over the edge with one contact and its friction", "[granular][shapes]")
{
    World world(room(2e-6), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.3, 0.9));
    world.add(frustum({0, 0, -5e-3}, {0, 0, 1}, 5e-3, 4e-3, 4e-3));
    const double at_rest = 0.99985 * R;
    world.add(Particle{.r = {3.98e-3, 0, at_rest}, .radius = R, .v = {0.03, 0, 0}, .omega = {0, 30, 0}});
    double tilt = 0, largest_jump = 0, largest_u = 0;
    Vec3 last = {0, 0, 0};
    bool on_edge = false;
    for (int n = 0; n < 30000; ++n) {
        world.step();
        const auto contacts = world.contacts();
        if (contacts.empty()) break;
        REQUIRE(contacts.size() == 1);
        const Vec3 u = contacts[0].u;
        tilt = std::acos(std::min(1., contacts[0].n.z));
        if (tilt > 0.01 && tilt < 0.4) {
            if (on_edge) largest_jump = std::max(largest_jump, (u - last).norm());
            largest_u = std::max(largest_u, u.norm()), on_edge = true;
        }
        last = u;
    }
    INFO("tilt " << tilt << ", largest u " << largest_u << " m, largest change " << largest_jump << " m");
    CHECK(on_edge);
    CHECK(tilt > 0.3);
    CHECK(largest_u > 0);
    CHECK(largest_jump < 0.05 * largest_u);
}

TEST_CASE("lathe meshes of a frustum converge to it at second order", "[granular][shapes][mesh]")
{
    const Boundary exact = frustum({0, 0, 0}, {0, 0, 1}, 4e-3, 3e-3, 1.5e-3);
    const auto error = [&](int segments) {
        Boundary b;
        b.shape = Shape::mesh;
        granular::Meshes meshes;
        meshes.add(granular::lathe_mesh({{0, 4e-3}, {1.5e-3, 4e-3}, {3e-3, 0}, {0, 0}}, segments), 0, false);
        const granular::Surfaces surfaces{&b, meshes.view()};
        double largest = 0;
        for (int k = 0; k < 400; ++k) {
            const double angle = 0.7 * k, z = -1.5e-3 + 7e-3 * (k % 41) / 40.,
                         rho = 1e-3 + 3e-3 * (k % 29) / 28.;
            const Vec3 at{rho * std::cos(angle), rho * std::sin(angle), z};
            const double distance = nearest(exact, at).distance;
            if (distance < 0.3e-3) continue;
            double least = 1;
            for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t)
                least =
                    std::min(least, surfaces.nearest(granular::Surfaces::first_triangle + t, at, 1).distance);
            largest = std::max(largest, std::abs(least - distance));
        }
        return largest;
    };
    const double coarse = error(12), middle = error(24), fine = error(48);
    INFO(coarse << ' ' << middle << ' ' << fine);
    CHECK(std::log2(coarse / middle) == Approx(2).margin(0.15));
    CHECK(std::log2(middle / fine) == Approx(2).margin(0.15));
}

TEST_CASE("a finite boundary far from the particles has no pairs", "[granular][shapes][neighbours]")
{
    World world(room(1e-6), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.7));
    Boundary disk;
    disk.shape = Shape::disk, disk.radius = 2e-3, disk.r = {0.01, 0.01, 0.002};
    world.add(frustum({-0.01, 0, 0.002}, {0, 1, 0}, 4e-3, 1e-3, 2e-3)), world.add(disk);
    for (int k = 0; k < 8; ++k) world.add(Particle{.r = {-0.012 + 3e-3 * k, -0.01, 0}, .radius = R});
    world.step(1);
    CHECK(world.candidates() == 0);
}

TEST_CASE("a particle that is larger than a finite bowl is refused", "[granular][shapes]")
{
    World world(room(1e-6), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.7));
    Boundary b = frustum({0, 0, -5e-3}, {0, 0, 1}, 0.01, 0.9 * R, 0.8 * R);
    b.inside = 1;
    world.add(b);
    world.add(Particle{.r = {0, 0, 0}, .radius = R});
    CHECK_THROWS_WITH(world.step(0), Catch::Contains("must be smaller than boundary 0"));
}

TEST_CASE("dimensions that a finite boundary cannot have are refused", "[granular][shapes]")
{
    World world(room(1e-6), {glass()});
    const Vec3 z{0, 0, 1};
    const double nan = std::nan("");
    CHECK_THROWS_WITH(world.add(frustum({0, 0, 0}, z, -1, 1, 1)), Catch::Contains("length must be positive"));
    CHECK_THROWS_WITH(world.add(frustum({0, 0, 0}, z, nan, 1, 1)),
                      Catch::Contains("length must be positive"));
    CHECK_THROWS_WITH(world.add(frustum({0, 0, 0}, z, 1, 0, 0)), Catch::Contains("one radius"));
    CHECK_THROWS_WITH(world.add(frustum({0, 0, 0}, z, 1, -1, 2)), Catch::Contains("must not be negative"));
    Boundary b = frustum({0, 0, 0}, z, 1, 1, 2);
    b.flags = granular::two_sided_surface;
    CHECK_THROWS_WITH(world.add(b), Catch::Contains("must have open ends"));
    b.flags = 0, b.sine = 0;
    CHECK_THROWS_WITH(world.add(b), Catch::Contains("half angle of a frustum"));
    Boundary torus;
    torus.shape = Shape::torus, torus.radius = 1, torus.second_radius = 0.5;
    CHECK_THROWS_WITH(world.add(torus), Catch::Contains("ring of a torus must be larger than its tube"));
}

}  // namespace finite_boundaries_test
