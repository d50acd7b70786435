// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts with round boundaries: the curvature at the contact and the Hertzian force with it.
#include "granular/world/double_world.hpp"
#include "granular/world/world.hpp"
#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <numbers>
#include <string>

using namespace hilda::granular;
using Shape = Boundary::Shape;

namespace round_boundaries_test {

namespace {

constexpr double R = 2e-3;  // [m]

Material glass() { return {.name = "glass", .density = 2500, .E = 7e7, .nu = 0.24}; }

Boundary round(Shape shape, bool inside, double radius, double half_angle = 0.4)
{
    Boundary b;
    b.shape = shape, b.inside = inside ? 1 : 0;
    b.r = {0.011, 0.012, 0.013}, b.axis = (1 / std::sqrt(14.)) * Vec3{1, -2, 3};
    b.radius = radius, b.cosine = std::cos(half_angle), b.sine = std::sin(half_angle);
    return b;
}

struct Case {
    std::string name;
    Boundary b;
    double R_eff;  ///< of a particle with the radius R at the distance `rho` of a cone from its axis [m]
};

constexpr double rho = 5e-3;

std::vector<Case> cases()
{
    const auto from_curvature = [](double curvature) { return 1 / (1 / R + curvature); };
    const double of_cone = std::cos(0.4) / (2 * rho);
    return {{"plane", round(Shape::plane, false, 0), R},
            {"large ball", round(Shape::sphere, false, 12.7e-3), from_curvature(1 / 12.7e-3)},
            {"small ball", round(Shape::sphere, false, 0.5e-3), from_curvature(1 / 0.5e-3)},
            {"narrow bowl", round(Shape::sphere, true, 2.2e-3), from_curvature(-1 / 2.2e-3)},
            {"rod", round(Shape::cylinder, false, 3e-3), from_curvature(0.5 / 3e-3)},
            {"tube", round(Shape::cylinder, true, 2.2e-3), from_curvature(-0.5 / 2.2e-3)},
            {"around a cone", round(Shape::cone, false, 0), from_curvature(of_cone)},
            {"in a cone", round(Shape::cone, true, 0), from_curvature(-of_cone)}};
}

/// Position of the centre of a particle with the radius R whose overlap with the boundary is delta [m]
Vec3 in_contact(const Boundary& b, double delta)
{
    const Vec3 e = (1 / std::sqrt(5.)) * Vec3{2, 1, 0}, f = b.axis.cross(e);  // normal to the axis
    const double far = R - delta, sign = b.inside != 0 ? -1 : 1;
    switch (b.shape) {
        case Shape::plane:
            return b.r + 3e-3 * e + far * b.axis;
        case Shape::cylinder:
            return b.r + 3e-3 * b.axis + (b.radius + sign * far) * e;
        case Shape::cone:
            return b.r + (rho / b.sine) * (b.sine * e + b.cosine * b.axis) +
                   sign * far * (b.cosine * e - b.sine * b.axis);
        default:  // a sphere
            break;
    }
    return b.r + (b.radius + sign * far) * (0.6 * e - 0.8 * f);
}

}  // namespace

TEST_CASE("the curvature of a boundary is half the divergence of its normal", "[granular][shapes]")
{
    for (const Case& c : cases()) {
        INFO(c.name);
        const Vec3 at = in_contact(c.b, R);  // on the surface
        REQUIRE(std::abs(nearest(c.b, at).distance) < 1e-17);
        constexpr double e = 1e-7;
        const auto slope = [&](const Vec3& direction) {
            return (nearest(c.b, at + e * direction).n - nearest(c.b, at - e * direction).n).dot(direction) /
                   (2 * e);
        };
        const double half_divergence = 0.5 * (slope({1, 0, 0}) + slope({0, 1, 0}) + slope({0, 0, 1}));
        CHECK(nearest(c.b, at).curvature == Approx(half_divergence).epsilon(1e-6).margin(1e-6));
        // The closest point is the same along the normal.
        CHECK(nearest(c.b, at + 1e-4 * nearest(c.b, at).n).curvature ==
              Approx(nearest(c.b, at).curvature).epsilon(1e-10));
    }
}

TEST_CASE("the normal force on a round boundary is that of Hertz with both curvatures", "[granular][shapes]")
{
    for (const Case& c : cases()) {
        INFO(c.name);
        constexpr double delta = 2e-5;
        const PairLaw law = hertz_mindlin(glass(), 0.5);
        const double E_eff = Hertz::of_materials(glass(), glass(), 0.5).E_eff,
                     F = 4. / 3 * E_eff * std::sqrt(c.R_eff * delta) * delta;
        Particle p;
        p.r = in_contact(c.b, delta), p.radius = R;

        WorldOptions o;
        o.low = {0, 0, 0}, o.high = {0.05, 0.05, 0.05}, o.h = 1e-7, o.gravity = {0, 0, 0};
        World world(o, {glass()});
        world.set_law(0, 0, law);
        world.add(c.b);
        world.add(p);
        world.step(0);
        REQUIRE(world.contacts().size() == 1);
        const ContactRecord contact = world.contacts()[0];
        CHECK(contact.F.dot(contact.n) == Approx(F).epsilon(1e-4));

        DoubleWorld in_double(o, law);
        p.mass = 1e-4;
        in_double.particle = {p};
        in_double.boundary = {c.b};
        in_double.step(1);
        const Vec3 n = nearest(c.b, p.r).n;
        CHECK(in_double.particle[0].v.dot(n) == Approx(F / p.mass * 1e-7).epsilon(1e-4));
    }
}

TEST_CASE("a particle on the apex of a cone is in contact as with a sphere of its size", "[granular][shapes]")
{
    const Boundary outside = round(Shape::cone, false, 0), inside = round(Shape::cone, true, 0);
    const Vec3 beyond_apex = outside.r - 0.9 * R * outside.axis,
               on_axis = inside.r + R / inside.sine * inside.axis;
    CHECK(effective_radius(outside, R, nearest(outside, beyond_apex)) == Approx(R / 2));
    CHECK(effective_radius(inside, R, nearest(inside, on_axis)) == Approx(2 * R));
}

TEST_CASE("a particle that is larger than the boundary around it is refused", "[granular][shapes]")
{
    const auto shape = GENERATE(Shape::sphere, Shape::cylinder);
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = {0.05, 0.05, 0.05}, o.h = 1e-7;
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5));
    world.add(round(shape, true, 0.9 * R));
    Particle p;
    p.r = round(shape, true, 0).r, p.radius = R;
    world.add(p);
    CHECK_THROWS_WITH(world.step(0), Catch::Contains("particle 0") &&
                                         Catch::Contains("must be smaller than") && Catch::Contains("0.002"));
}

TEST_CASE("a bowl little larger than a particle shortens the collision time", "[granular][shapes]")
{
    const auto collision_time = [](double bowl) {
        WorldOptions o;
        o.low = {0, 0, 0}, o.high = {0.05, 0.05, 0.05}, o.h = 1e-7;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.5));
        world.add(round(Shape::sphere, true, bowl));
        Particle p;
        p.r = round(Shape::sphere, true, 0).r, p.radius = R;
        world.add(p);
        return world.step_limits().collision;
    };
    // t ~ (m²/R*)^(1/5): R* = 11 R in the bowl, R/2 and half the mass for two equal particles
    CHECK(collision_time(1.1 * R) / collision_time(10 * R) == Approx(std::pow(2 / 11., 0.2)).epsilon(1e-6));
}

TEST_CASE("the narrow end of a light frustum shortens the collision time, whichever end it is",
          "[granular][shapes]")
{
    const auto collision_time = [](double from, double to) {
        WorldOptions o;
        o.low = {0, 0, 0}, o.high = {0.05, 0.05, 0.05}, o.h = 1e-7;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.5));
        Particle p;
        p.r = {0.025, 0.025, 0.025}, p.radius = R;
        Boundary tool = frustum({0.025, 0.025, 0.01}, {0, 0, 1}, 0.02, from, to);
        const double m = 4. / 3 * M_PI * R * R * R * glass().density;
        tool.inside = 1, tool.mass = 0.1 * m;
        world.add(tool);
        world.add(p);
        return world.step_limits().collision;
    };
    // t ~ (m*²/R*)^(1/5): m* = m/11 and 1/R* = 1/R - cos/(2 ρ), at least 1/(2 R), at the radius ρ of the
    // narrow end; m/2 and R/2 for two equal particles
    const double equal = collision_time(10 * R, 9 * R);
    for (const double narrow : {0., 0.3 * R, 1.5 * R}) {
        const double slant = std::hypot(0.02, 6 * R - narrow), cosine = 0.02 / slant,
                     R_eff = narrow == 1.5 * R ? R / (1 - cosine * R / (2 * narrow)) : 2 * R;
        const double ratio = std::pow(std::pow(2 / 11., 2) * (R / 2) / R_eff, 0.2);
        CHECK(collision_time(narrow, 6 * R) / equal == Approx(ratio).epsilon(1e-6));
        CHECK(collision_time(6 * R, narrow) / equal == Approx(ratio).epsilon(1e-6));
    }
}

}  // namespace round_boundaries_test
