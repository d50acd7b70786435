// SPDX-License-Identifier: GPL-3.0-or-later
// What a world refuses: each message has the place, the rule and the value. A refused call changes nothing.
#include "tests/support/grains.hpp"

#include "granular/case/case_file.hpp"
#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <limits>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;

namespace refusals_test {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN(),
                 infinite = std::numeric_limits<double>::infinity();

WorldOptions cube()
{
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = {1, 1, 1}, o.h = 1e-5;
    return o;
}

/// The message with which f refuses
std::string refusal(const std::function<void()>& f)
{
    try {
        f();
    } catch (const io::InvalidInput& e) {
        return e.what();
    }
    return "nothing is refused";
}

}  // namespace

TEST_CASE("a world refuses a wrong domain, step, skin or material", "[granular][refusals]")
{
    const auto options = [](const std::function<void(WorldOptions&)>& change) {
        return refusal([&] {
            WorldOptions o = cube();
            change(o);
            World(o, {glass()});
        });
    };
    CHECK(options([](WorldOptions& o) { o.high.y = 0; }) ==
          "domain: the high end along y must be above the low one, got 0");
    CHECK(options([](WorldOptions& o) { o.high.z = infinite; }) ==
          "domain: the high end along z must be above the low one, got inf");
    CHECK(options([](WorldOptions& o) { o.low.x = -infinite; }) ==
          "domain: the high end along x must be above the low one, got -inf");
    CHECK(options([](WorldOptions& o) { o.h = 0; }) == "step: must be positive, got 0");
    CHECK(options([](WorldOptions& o) { o.h = infinite; }) == "step: must be positive, got inf");
    CHECK(options([](WorldOptions& o) { o.skin = 0; }) == "skin: must be in (0, 1] diameters, got 0");
    CHECK(options([](WorldOptions& o) { o.skin = 1.5; }) == "skin: must be in (0, 1] diameters, got 1.5");

    const auto material = [](const Material& m) { return refusal([&] { World(cube(), {glass(), m}); }); };
    CHECK(material({"lead", 0, 1e9, 0.3}) == "material 'lead': density must be positive, got 0");
    CHECK(material({"lead", infinite, 1e9, 0.3}) == "material 'lead': density must be positive, got inf");
    CHECK(material({"lead", 1e4, -1e9, 0.3}) == "material 'lead': E must be positive, got -1e+09");
    CHECK(material({"lead", 1e4, infinite, 0.3}) == "material 'lead': E must be positive, got inf");
    CHECK(material({"lead", 1e4, 1e9, 0.5}) == "material 'lead': nu must be between -1 and 0.5, got 0.5");
    CHECK(material({"lead", 1e4, 1e9, -1}) == "material 'lead': nu must be between -1 and 0.5, got -1");
    CHECK(refusal([] { World(cube(), std::vector<Material>(4097, glass())); }) ==
          "materials: there must not be more than 4096, got 4097");
}

TEST_CASE("a world refuses wrong boundaries, laws and velocities", "[granular][refusals]")
{
    World world(cube(), {glass()});
    const PairLaw law = hertz_mindlin(glass(), 0.9);
    CHECK(refusal([&] { world.set_law(0, 1, law); }) == "law: no material has this number, got 1");
    CHECK(refusal([&] { world.set_law(-1, 0, law); }) == "law: no material has this number, got -1");
    for (int k = 0; k < 255; ++k) world.set_law(0, 0, law);
    CHECK(refusal([&] { world.set_law(0, 0, law); }) == "law: no more than 255 laws are possible, got 256");

    const auto boundary = [&](const Boundary& b) { return refusal([&] { world.add(b); }); };
    using Shape = Boundary::Shape;
    CHECK(boundary({.material = 1}) == "boundary: no material has this number, got 1");
    CHECK(boundary({.material = -1}) == "boundary: no material has this number, got -1");
    const auto not_finite = [&](const Boundary& b) {
        const std::string text = boundary(b),
                          expected = "boundary: position, velocities, force and torque must be finite, got ";
        return text.starts_with(expected) ? text.substr(expected.size()) : text;
    };
    CHECK(not_finite({.r = {none, 0, 0}}) == "nan");
    CHECK(not_finite({.v = {0, -infinite, 0}}) == "-inf");
    CHECK(not_finite({.omega = {0, 0, infinite}}) == "inf");
    CHECK(not_finite({.F = {infinite, 0, 0}}) == "inf");
    for (const Shape shape : {Shape::cylinder, Shape::sphere}) {
        CHECK(boundary({.shape = shape}) == "boundary: the radius must be positive, got 0");
        CHECK(boundary({.shape = shape, .radius = infinite}) ==
              "boundary: the radius must be positive, got inf");
    }
    CHECK(boundary({.shape = Shape::cone, .axis = {0, 3, 0}}) ==
          "boundary: the length of axis must be 1, got 3");
    CHECK(boundary({.mass = -2}) == "boundary: the mass must be finite and not negative, got -2");
    const std::string moments =
        "boundary: the principal moments of inertia must be positive, and none larger than the sum of the "
        "others, got ";
    CHECK(boundary({.mass = 2, .inertia = -3}) == moments + "((-3, 0, 0), (0, -3, 0), (0, 0, -3))");
    const std::array<double, 6> rod = {2, 2, 0, 0, 0, 0}, long_rod = {1, 1, 2.1, 0, 0, 0},
                                full = {2, 2, 2, 3, 0, 0}, disk = {1, 1, 2, 0, 0, 0};
    CHECK(boundary({.mass = 2, .inertia = rod}) == moments + "((2, 0, 0), (0, 2, 0), (0, 0, 0))");
    CHECK(boundary({.mass = 2, .inertia = long_rod}) == moments + "((1, 0, 0), (0, 1, 0), (0, 0, 2.1))");
    CHECK(boundary({.mass = 2, .inertia = full}) == moments + "((2, 3, 0), (3, 2, 0), (0, 0, 2))");
    CHECK_NOTHROW(world.add({.mass = 2, .inertia = disk}));
    CHECK(boundary({.mass = infinite}) == "boundary: the mass must be finite and not negative, got inf");
    CHECK(boundary({.mass = 1, .inertia = infinite}) == moments + "((inf, 0, 0), (0, inf, 0), (0, 0, inf))");

    world.add(Particle{.r = {0.5, 0.5, 0.5}, .radius = 0.01});
    CHECK(refusal([&] { world.set_velocity(1, {}, {}); }) == "velocity: no particle has this id, got 1");
    CHECK(refusal([&] {
              world.set_velocity(0, {none, 0, 0}, {});
          }) == "velocity of particle 0: must be finite, got nan");
    CHECK(refusal([&] {
              world.set_velocity(0, {1, 0, 0}, {0, infinite, 0});
          }) == "velocity of particle 0: must be finite, got inf");
    CHECK(refusal([&] {
              world.set_force(0, {0, none, 0});
          }) == "force on particle 0: must be finite, got nan");
    CHECK(refusal([&] {
              world.set_force(0, {0, -1e40, 0});
          }) == "force on particle 0: must be in the range of single precision, up to 3.4e38, got -1e+40");
    CHECK(world.count() == 1);
    CHECK(world.particles()[0].v == granular::Vec3{0, 0, 0});
}

TEST_CASE("a world refuses wrong particles and names their ids", "[granular][refusals]")
{
    World world(cube(), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.9));
    world.add(Particle{.r = {0.5, 0.5, 0.5}, .radius = 0.01});
    const auto particle = [&](const std::function<void(Particle&)>& change) {
        Particle p{.r = {0.2, 0.2, 0.2}, .radius = 0.01};
        change(p);
        return refusal([&] { world.add(p); });
    };
    for (const double wrong : {0., -1., infinite, none})
        CHECK_THAT(particle([&](Particle& p) { p.radius = wrong; }),
                   Catch::StartsWith("particle 1: the radius must be positive, got "));
    CHECK(particle([](Particle& p) { p.r.x = none; }) ==
          "particle 1: position and velocities must be finite, got nan");
    CHECK(particle([](Particle& p) { p.v.y = infinite; }) ==
          "particle 1: position and velocities must be finite, got inf");
    CHECK(particle([](Particle& p) { p.omega.z = none; }) ==
          "particle 1: position and velocities must be finite, got nan");
    CHECK(particle([](Particle& p) { p.material = 3; }) == "particle 1: no material has this number, got 3");
    CHECK(particle([](Particle& p) { p.material = -1; }) ==
          "particle 1: no material has this number, got -1");
    CHECK(particle([](Particle& p) { p.mass = -2; }) == "particle 1: the mass must not be negative, got -2");
    CHECK(particle([](Particle& p) { p.mass = infinite; }) ==
          "particle 1: the mass must not be negative, got inf");
    CHECK(particle([](Particle& p) { p.mass = 1e-40; }) ==
          "particle 1: the mass must be in the range of single precision, 1.2e-38 to 8.5e37 kg, got 1e-40");
    CHECK(particle([](Particle& p) { p.mass = 1e-40, p.fixed = true; }) == "nothing is refused");
    CHECK(world.count() == 2);
    const std::vector<Particle> second_is_wrong = {{.r = {0.7, 0.7, 0.7}, .radius = 0.01}, {.radius = -1}};
    CHECK(refusal([&] { world.add(second_is_wrong); }) == "particle 3: the radius must be positive, got -1");
    CHECK(world.count() == 2);
    CHECK(world.add(std::vector(second_is_wrong.begin(), second_is_wrong.begin() + 1)) == 2);
    CHECK(refusal([&] {
              world.set_velocities({2, 3}, {{1, 0, 0}, {1, 0, 0}}, {});
          }) == "velocity: no particle has this id, got 3");
    CHECK(refusal([&] {
              world.set_velocities({2, 0}, {{1, 0, 0}, {1e40, 0, 0}}, {});
          }) == "velocity of particle 0: must be in the range of single precision, up to 3.4e38, got 1e+40");
    CHECK(world.particles()[2].v == granular::Vec3{0, 0, 0});
}

TEST_CASE("a world refuses a domain of too many or too few cells", "[granular][refusals]")
{
    const auto domain = [](double radius, double wide, bool periodic = false) {
        WorldOptions o = cube();
        o.high = {1, 1, wide}, o.periodic[2] = periodic;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.9));
        world.add(Particle{.r = {0.5, 0.5, wide / 2}, .radius = radius});
        return refusal([&] { world.step(0); });
    };
    CHECK(domain(0.1, 1) == "nothing is refused");
    CHECK(domain(0.1, 1, true) == "nothing is refused");
    CHECK(domain(1e-4, 0.2) == "nothing is refused");  // 4546 cells along x
    CHECK_THAT(
        domain(1e-5, 0.2),
        Catch::StartsWith("domain: must not have more than 2^31 cells in all replicas; cells that are "
                          "0.000") &&
            Catch::Contains("eight times the largest diameter and the skin, are the widest; cells, got"));
    CHECK(domain(0.2, 1, true) == "nothing is refused");
    CHECK_THAT(domain(0.2, 0.43, true),
               Catch::StartsWith("domain: must be at least 0.44004 m wide along z, a periodic axis: ") &&
                   Catch::EndsWith("got 0.43"));
}

TEST_CASE("a checkpoint of a world with other options is refused with the reason",
          "[granular][refusals][checkpoint]")
{
    const auto world = [](granular::Scheme scheme, bool orientation, int boundaries, int particles) {
        WorldOptions o = cube();
        o.scheme = scheme, o.orientation = orientation;
        World w(o, {glass()});
        w.set_law(0, 0, hertz_mindlin(glass(), 0.9));
        for (int k = 0; k < boundaries; ++k) w.add(Boundary{});
        for (int k = 0; k < particles; ++k) w.add(Particle{.r = {0.3 * (k + 1), 0.5, 0.5}, .radius = 0.01});
        return w;
    };
    using Scheme = granular::Scheme;
    const auto plain = Scheme::symplectic_euler;
    const std::string bytes = world(plain, false, 1, 2).to_bytes("run");
    const auto read = [&](World&& w, const std::string& from) {
        try {
            w.from_bytes(from, "run", "checkpoint");
        } catch (const io::IoError& e) {
            return std::string(e.what());
        }
        return std::string("accepted");
    };
    CHECK(read(world(plain, false, 1, 2), bytes) == "accepted");
    CHECK_THAT(read(world(Scheme::chung, false, 1, 2), bytes),
               Catch::Contains("an array of another integrator"));
    CHECK_THAT(read(world(plain, false, 2, 2), bytes),
               Catch::Contains("other boundaries than in this world"));
    CHECK(read(world(plain, true, 1, 2), bytes) ==
          "checkpoint: the checkpoint has no orientations, but /orientation of this case is true");
    CHECK(read(world(plain, false, 1, 2), world(plain, true, 1, 2).to_bytes("run")) ==
          "checkpoint: the checkpoint has orientations, but /orientation of this case is false");
}

}  // namespace refusals_test
