// SPDX-License-Identifier: GPL-3.0-or-later
// The motion of clumps: one sphere is a particle, free clumps in closed form, collisions, outflow.
#include "granular/backend/split_mix.hpp"
#include "granular/core/rigid_body.hpp"
#include "io/error.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <string_view>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Clump;
using granular::EulerParameters;
using granular::Lever;
using granular::Random;
using granular::rotated;
using granular::rotated_back;
using granular::Scheme;
using granular::solid_clump;
using granular::Sphere;
using granular::turned;

namespace clump_motion_test {

namespace {

constexpr double R = 1e-3;

WorldOptions room(double h, Scheme scheme = Scheme::symplectic_euler)
{
    WorldOptions o;
    o.low = {-20 * R, -20 * R, -20 * R}, o.high = {20 * R, 20 * R, 20 * R};
    o.h = h, o.scheme = scheme;
    o.gravity = {0, 0, 0};
    return o;
}

World glass_world(const WorldOptions& o, Lever lever = Lever::radius)
{
    World world(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.6, 0.4);
    law.lever = lever;
    world.set_law(0, 0, law);
    return world;
}

const std::vector<Sphere> one = {{{0, 0, 0}, R}};
const std::vector<Sphere> pair = {{{0.8 * R, 0, 0}, R}, {{-0.8 * R, 0, 0}, R}};
const std::vector<Sphere> three = {
    {{0, 0, 0}, R}, {{1.2 * R, 0.3 * R, 0}, 0.8 * R}, {{0, R, 0.7 * R}, 0.6 * R}};

EulerParameters<double> orientation(const Clump& c) { return {c.e[0], {c.e[1], c.e[2], c.e[3]}}; }

/// Rotation angle between two orientations [rad]
double angle(const EulerParameters<double>& p, const EulerParameters<double>& q)
{
    const Vec3 e = p.e0 * q.e - q.e0 * p.e - p.e.cross(q.e);
    return 2 * std::asin(std::min(1., e.norm()));
}

/// Total linear and angular momentum of the clumps, about the origin
struct Momenta {
    Vec3 p{0, 0, 0}, L{0, 0, 0};
};
Momenta momenta(const World& world)
{
    Momenta sum;
    for (const Clump& c : world.clumps()) sum.p += c.mass * c.v, sum.L += c.L + c.r.cross(c.mass * c.v);
    return sum;
}

}  // namespace

TEST_CASE("a clump of one sphere has the bits of a particle", "[granular][clumps]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::forward_euler,
                                   Scheme::extended_taylor, Scheme::chung);
    const bool periodic = GENERATE(false, true);
    WorldOptions options = room(2e-6, scheme);
    options.gravity = {0.3, -0.2, -9.81};
    options.low = {-6 * R, -6 * R, -6 * R}, options.high = {6 * R, 6 * R, 6 * R};
    options.periodic = {periodic, periodic, false};
    std::array<World, 2> world{glass_world(options), glass_world(options)};
    for (World& w : world) {
        w.set_watch(true);
        for (const Boundary& b : granular::open_box(options.low, options.high)) w.add(b);
    }
    const int shape = world[1].add_template(solid_clump("one", one, glass().density));
    Random random(4);
    for (int k = 0; k < 5 * 5 * 3; ++k) {
        const int row = k / 5 % 5, layer = k / 25;
        const Vec3 r{(-4.4 + 2.2 * (k % 5)) * R, (-4.4 + 2.2 * row) * R, (-4 + 2.2 * layer) * R};
        const Vec3 v = 0.8 * random.direction(), omega = 300 * random.direction();
        const double radius = random.number(0.8, 1) * R;
        world[0].add(Particle{.r = r, .radius = radius, .v = v, .omega = omega});
        world[1].add_clump(Clump{.shape = shape, .r = r, .v = v, .omega = omega, .scale = radius / R});
    }
    std::size_t contacts = 0;
    for (int k = 0; k < 10; ++k) {
        for (World& w : world) w.step(300);
        contacts += world[0].totals().contacts;
        const auto a = world[0].particles(), b = world[1].particles();
        for (std::size_t n = 0; n < a.size(); ++n) {
            REQUIRE(a[n].r == b[n].r);
            REQUIRE(a[n].v == b[n].v);
            REQUIRE(a[n].omega == b[n].omega);
        }
        const World::Sums s = world[0].sums(), t = world[1].sums();
        CHECK(s.kinetic_energy == t.kinetic_energy);
        CHECK(s.rotational_energy == t.rotational_energy);
        CHECK(s.potential_energy == t.potential_energy);
        CHECK(s.momentum == t.momentum);
        CHECK(world[0].totals().stress == world[1].totals().stress);
        const auto bytes = [](const granular::WatchRecord& w) {
            return std::string_view(reinterpret_cast<const char*>(&w), sizeof(w));
        };
        CHECK(bytes(world[0].watch()) == bytes(world[1].watch()));
        CHECK(world[0].rebuilds() == world[1].rebuilds());
    }
    CHECK(contacts > 10);
}

TEST_CASE("a free dumb-bell converges to its closed form at order 2 and keeps its angular momentum",
          "[granular][clumps]")
{
    // A(t) = exp(t L/J_2) A_0 exp(t (1 - J_1/J_2) ω̄_1 e_1): precession about L, spin about the axis e_1
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    const granular::ClumpTemplate t = solid_clump("pair", pair, glass().density);
    const double J1 = t.inertia.xx, J2 = t.inertia.yy, end = 0.4;
    const EulerParameters<double> p = turned({1, {0, 0, 0}}, {0.3, -0.8, 0.4});
    const Vec3 omega{20, -10, 30}, L = rotated(p, t.inertia * rotated_back(p, omega));
    const EulerParameters<double> own =
        turned({1, {0, 0, 0}}, {end * (1 - J1 / J2) * rotated_back(p, omega).x, 0, 0});
    const EulerParameters<double> first = {p.e0 * own.e0 - p.e.dot(own.e),
                                           p.e0 * own.e + own.e0 * p.e + p.e.cross(own.e)};
    const EulerParameters<double> expected = turned(first, (end / J2) * L);
    std::vector<double> errors;
    for (const long steps : {200, 400, 800}) {
        World world = glass_world(room(end / double(steps), scheme));
        world.set_watch(true);
        const int shape = world.add_template(t);
        world.add_clump(
            Clump{.shape = shape, .e = {p.e0, p.e.x, p.e.y, p.e.z}, .v = {0.01, 0, 0}, .omega = omega});
        CHECK((world.clumps()[0].L - L).norm() < 1e-14 * L.norm());
        world.step(0);
        const Vec3 before = world.clumps()[0].L;
        CHECK((before - L).norm() < 2e-7 * L.norm());  // m and R are in single precision
        const double E = world.sums().kinetic_energy;
        world.step(steps);
        const Clump c = world.clumps()[0];
        errors.push_back(angle(orientation(c), expected));
        CHECK(c.L == before);
        CHECK((c.r - Vec3{0.01 * end, 0, 0}).norm() < 1e-7 * 0.01 * end);  // v is in single precision
        CHECK(world.sums().kinetic_energy == Approx(E).epsilon(2e-3));
        CHECK(world.watch().largest_gain < 2e-3 * E);
        // The spheres are where the pose of the clump puts them.
        const auto all = world.particles();
        for (int k = 0; k < 2; ++k) {
            const Vec3 d = rotated(orientation(c), pair[static_cast<std::size_t>(k)].r);
            CHECK((all[k].r - c.r - d).norm() < 1e-9 * R);
            CHECK((all[k].v - c.v - c.omega.cross(d)).norm() < 1e-7);
            CHECK((all[k].omega - c.omega).norm() < 1e-5);
        }
    }
    for (std::size_t k = 1; k < errors.size(); ++k) {
        INFO(errors[k - 1] << ' ' << errors[k]);
        CHECK(std::log2(errors[k - 1] / errors[k]) == Approx(2).margin(0.05));
    }
}

TEST_CASE("a free clump of three moments follows the leapfrog of rigid body boundaries", "[granular][clumps]")
{
    const granular::ClumpTemplate t = solid_clump("three", three, glass().density);
    const double h = 1e-4;
    const Vec3 omega{200, -100, 300};
    Boundary b;
    b.shape = Boundary::Shape::sphere, b.radius = R, b.mass = t.mass, b.inertia = t.inertia;
    b.p = turned({1, {0, 0, 0}}, {0.2, 0.1, -0.7}), b.omega = omega;
    World world = glass_world(room(h));
    const int shape = world.add_template(t);
    world.add_clump(Clump{.shape = shape, .e = {b.p.e0, b.p.e.x, b.p.e.y, b.p.e.z}, .omega = omega});
    world.step(0);
    const Vec3 L = world.clumps()[0].L;
    for (int k = 0; k < 300; ++k) rotate(b, mean_omega(b, h), h);
    world.step(300);
    const Clump c = world.clumps()[0];
    CHECK(angle(orientation(c), b.p) < 3e-6);  // h ω is in single precision
    CHECK((c.omega - b.omega).norm() < 1e-5 * omega.norm());
    CHECK(c.L == L);
}

TEST_CASE("clumps that collide keep their momenta", "[granular][clumps]")
{
    // With Lever::contact the forces on both bodies act at one point.
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    World world = glass_world(room(1e-6, scheme), Lever::contact);
    const int a = world.add_template(solid_clump("three", three, glass().density)),
              b = world.add_template(solid_clump("pair", pair, glass().density));
    world.add_clump(Clump{.shape = a, .r = {-3 * R, 0.4 * R, 0}, .v = {0.5, 0, 0}, .omega = {0, 50, 100}});
    world.add_clump(Clump{.shape = b, .r = {1 * R, 0, 0.2 * R}, .v = {-0.2, 0.1, 0}, .omega = {-70, 0, 20}});
    world.step(0);
    const Momenta before = momenta(world);
    const Vec3 spin = world.clumps()[0].L;
    bool touched = false;
    for (int k = 0; k < 200; ++k) {
        world.step(50);
        touched = touched || world.totals().contacts > 0;
    }
    CHECK(touched);
    CHECK((world.clumps()[0].L - spin).norm() > 0.1 * spin.norm());
    const Momenta after = momenta(world);
    CHECK((after.p - before.p).norm() < 1e-6 * before.p.norm());
    // Positions are those of integers, forces those of single precision.
    CHECK((after.L - before.L).norm() < 1e-4 * before.L.norm());
    // There is no contact within a clump.
    for (const granular::ContactRecord& c : world.contacts()) CHECK((c.i < 3) != (c.j < 3));
    CHECK(world.candidates() <= 6);
}

TEST_CASE("a clump that lies on a floor carries its weight there", "[granular][clumps]")
{
    WorldOptions options = room(5e-6);
    options.gravity = {0, 0, -9.81};
    World world = glass_world(options);
    Boundary floor;
    floor.r = {0, 0, -5 * R};
    world.add(floor);
    const granular::ClumpTemplate t = solid_clump("three", three, glass().density);
    const int shape = world.add_template(t);
    world.add_clump(Clump{.shape = shape, .r = {0, 0, -3.6 * R}});
    world.step(100000);
    const granular::Wrench on = world.wrench(0);
    CHECK(on.F.z == Approx(-9.81 * t.mass).epsilon(1e-3));
    CHECK(world.totals().contacts == 3);
    CHECK(world.sums().kinetic_energy < 1e-6 * t.mass * 9.81 * R);
    // The resultant of the contact forces acts at the centre of mass.
    const Clump c = world.clumps()[0];
    const Vec3 about_centre = on.T - (c.r - floor.r).cross(on.F);
    CHECK(about_centre.norm() < 1e-3 * 9.81 * t.mass * R);
}

TEST_CASE("a clump leaves the domain as a whole, with its centre of mass", "[granular][clumps][outflow]")
{
    WorldOptions options = room(1e-4);
    options.outflow = {false, true, false, false, false, false};
    World world = glass_world(options);
    const granular::ClumpTemplate t = solid_clump("pair", pair, glass().density);
    const int shape = world.add_template(t);
    world.add(Particle{.r = {-10 * R, 0, 0}, .radius = R, .v = {0.5, 0, 0}});
    world.add_clump(Clump{.shape = shape, .r = {17 * R, 0, 0}, .v = {0.5, 0, 0}, .omega = {0, 0, 1}});
    world.add_clump(Clump{.shape = shape, .r = {0, 5 * R, 0}});
    bool straddles = false;
    for (int k = 0; k < 100 && world.count() == 5; ++k) {
        world.step(1);
        const auto all = world.particles();
        for (const Particle& p : all) straddles = straddles || p.r.x > options.high.x;
        if (world.count() == 5) CHECK(world.clumps()[0].r.x < options.high.x + 0.2 * R);
    }
    CHECK(straddles);
    REQUIRE(world.count() == 3);
    REQUIRE(world.removed().size() == 2);
    CHECK(world.removed()[0].id == 1);
    CHECK(world.removed()[1].id == 2);
    CHECK(world.removed()[0].t == world.removed()[1].t);
    CHECK(world.outflow().mass == Approx(t.mass).epsilon(1e-6));
    CHECK(world.clumps()[0].id == 3);
    world.step(100);
    const auto all = world.particles();
    CHECK((all[1].r - all[2].r).norm() == Approx(1.6 * R).epsilon(1e-6));
}

TEST_CASE("a clump that turns too far in one step ends the run with the reason", "[granular][clumps]")
{
    World world = glass_world(room(1e-2));
    world.add_clump(Clump{.shape = world.add_template(solid_clump("pair", pair, glass().density)),
                          .omega = {0, 30, 150}});
    CHECK_THROWS_WITH(world.step(), Catch::Matchers::StartsWith("the clump of particle 0 turns by 1.5"));
}

TEST_CASE("invalid clumps are refused with place and value", "[granular][clumps]")
{
    using Catch::Matchers::Equals;
    using Catch::Matchers::StartsWith;
    World world = glass_world(room(1e-5));
    CHECK_THROWS_WITH(world.add_clump(Clump{.shape = 2}),
                      Equals("clump of particle 0: no clump has this number, got 2"));
    const int shape = world.add_template(solid_clump("pair", pair, glass().density));
    CHECK_THROWS_WITH(world.add_clump(Clump{.shape = shape, .scale = 0}),
                      Equals("clump of particle 0: the scale must be positive, got 0"));
    CHECK_THROWS_WITH(world.add_clump(Clump{.shape = shape, .e = {1, 1, 0, 0}}),
                      StartsWith("clump of particle 0: Euler parameters must have the length 1"));
    CHECK_THROWS_WITH(world.add_clump(Clump{.shape = shape, .v = {0, NAN, 0}}),
                      Equals("particle 0: position and velocities must be finite, got nan"));
    CHECK_THROWS_WITH(world.add_template(solid_clump("large", {{{0, 0, 0}, 30 * R}}, 2500)),
                      StartsWith("clump 'large': must not be larger than the domain, 0.04 m"));
    world.add_clump(Clump{.shape = shape});
    CHECK(world.count() == 2);
    world.step();
    CHECK_THROWS_WITH(world.set_velocity(1, {0, 0, 0}, {0, 0, 0}),
                      StartsWith("velocity of particle 1: must not be set, because it belongs to a clump"));
    WorldOptions narrow = room(1e-5);
    narrow.periodic = {true, false, false};
    World tube = glass_world(narrow);
    const int rod = tube.add_template(solid_clump("rod", {{{-18 * R, 0, 0}, R}, {{18 * R, 0, 0}, R}}, 2500));
    CHECK_THROWS_WITH(
        tube.add_clump(Clump{.shape = rod}),
        StartsWith("clump of particle 0: along x, a periodic axis, the domain must be at least 1.1"));
}

TEST_CASE("particles can be added after the last clump has left", "[granular][clumps][outflow]")
{
    WorldOptions options = room(1e-4);
    options.outflow = {false, true, false, false, false, false};
    World world = glass_world(options);
    world.add_clump(Clump{.shape = world.add_template(solid_clump("pair", pair, glass().density)),
                          .r = {19 * R, 0, 0},
                          .v = {0.5, 0, 0}});
    while (world.count() > 0 && world.steps() < 1000) world.step();
    REQUIRE(world.count() == 0);
    for (int k = 0; k < 500; ++k) {
        const int row = k / 10 % 10 - 5, layer = k / 100 - 2;
        world.add(Particle{
            .r = {(k % 10 - 5) * 3 * R, row * 3 * R, layer * 3 * R}, .radius = R, .v = {0.01, 0, 0}});
    }
    world.step(10);
    for (const Particle& p : world.particles()) CHECK((p.v - Vec3{0.01, 0, 0}).norm() < 1e-9);
}

TEST_CASE("a clump is removed as a whole by the id of any of its particles", "[granular][clumps][outflow]")
{
    for (std::uint32_t member = 0; member < 5; ++member) {
        WorldOptions o = room(1e-6);
        o.removable = true;
        World world = glass_world(o);
        const int shape = world.add_template(solid_clump("bent", three, glass().density));
        world.add_clump(Clump{.shape = shape, .r = {-10 * R, 0, 0}});  // ids 0, 1, 2
        world.add(Particle{.r = {0, 0, 0}, .radius = R});              // 3
        const std::uint32_t other = world.add_clump(Clump{.shape = shape, .r = {10 * R, 0, 0}});  // 4, 5, 6
        world.step(1);
        REQUIRE(other == 4);
        world.remove({member, 99});
        const bool of_clump = member != 3;
        CHECK(world.count() == (of_clump ? 4u : 6u));
        CHECK(world.clumps().size() == (of_clump ? 1u : 2u));
        const std::uint32_t first = member == 3 ? 3 : member > 3 ? 4 : 0;
        REQUIRE(world.removed().size() == (of_clump ? 3u : 1u));
        for (std::uint32_t k = 0; k < world.removed().size(); ++k) CHECK(world.removed()[k].id == first + k);
        world.step(10);
    }
}

TEST_CASE("a periodic axis must be three times as long as the reach of a clump", "[granular][clumps]")
{
    WorldOptions options = room(1e-5);
    options.low = {0, 0, 0}, options.high = {18 * R, 40 * R, 40 * R};
    options.periodic = {true, false, false};
    World world = glass_world(options);
    const int rod = world.add_template(
        solid_clump("rod", {{{-6.5 * R, 0, 0}, R}, {{0, 0, 0}, R}, {{6.5 * R, 0, 0}, R}}, glass().density));
    world.add_clump(Clump{.shape = rod, .r = {9 * R, 20 * R, 20 * R}});
    CHECK_THROWS_WITH(world.step(),
                      Catch::Matchers::Contains("along x, a periodic axis: three times the distance "
                                                "of a sphere from the centre of mass of its clump"));
}

TEST_CASE("the spheres of a clump keep its orientation, also of one with equal moments", "[granular][clumps]")
{
    WorldOptions options = room(1e-5);
    options.orientation = true, options.gravity = {0, 0, -9.81};
    World world = glass_world(options);
    world.add(Boundary{.r = {0, 0, -3 * R}});
    std::vector<Sphere> octahedron;
    for (const double s : {-1., 1.})
        for (const Vec3& e : {Vec3{s, 0, 0}, {0, s, 0}, {0, 0, s}}) octahedron.push_back({R * e, R});
    const int shape = world.add_template(solid_clump("octahedron", octahedron, glass().density));
    world.add_clump(Clump{.shape = shape, .v = {0.3, 0, 0}, .omega = {10, 20, 30}});
    world.step(4000);
    const EulerParameters<double> p = orientation(world.clumps()[0]);
    CHECK(angle(p, {1, {0, 0, 0}}) > 0.1);
    for (const Particle& one : world.particles())
        CHECK(angle({one.e[0], {one.e[1], one.e[2], one.e[3]}}, p) < 1e-5);
}

TEST_CASE("the limits of the step are the same before and after the insertion of clumps",
          "[granular][clumps]")
{
    World world = glass_world(room(1e-6));
    world.add_clump(Clump{.shape = world.add_template(solid_clump("three", three, glass().density))});
    const World::StepLimits before = world.step_limits();
    world.step();
    CHECK(world.step_limits().collision == Approx(before.collision).epsilon(1e-6));
    CHECK(world.step_limits().rayleigh == Approx(before.rayleigh).epsilon(1e-6));
}

}  // namespace clump_motion_test
