// SPDX-License-Identifier: GPL-3.0-or-later
// Orientations: rotations in closed form, rotations below single precision, rolling of a ball.
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::DoubleWorld;
using granular::Scheme;

namespace {

using Four = std::array<double, 4>;

/// p ⊗ q
Four product(const Four& p, const Four& q)
{
    const Vec3 a{p[1], p[2], p[3]}, b{q[1], q[2], q[3]}, v = p[0] * b + q[0] * a + a.cross(b);
    return {p[0] * q[0] - a.dot(b), v.x, v.y, v.z};
}

/// Euler parameters of a rotation vector
Four of_rotation(const Vec3& angle)
{
    const double chi = angle.norm();
    const Vec3 e = (chi > 0 ? std::sin(chi / 2) / chi : 0.5) * angle;
    return {std::cos(chi / 2), e.x, e.y, e.z};
}

/// Angle of the relative rotation, independent of the signs of p and q [rad]
double between(const Four& p, const Four& q)
{
    const Four d = product({p[0], -p[1], -p[2], -p[3]}, q);
    return 2 * std::atan2(std::sqrt(d[1] * d[1] + d[2] * d[2] + d[3] * d[3]), std::abs(d[0]));
}

WorldOptions with_orientation(double h)
{
    WorldOptions o;
    o.low = {-1, -1, -1}, o.high = {1, 1, 1};
    o.gravity = {0, 0, 0}, o.h = h, o.orientation = true;
    return o;
}

World empty(const WorldOptions& o)
{
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.6, 0.4));
    return world;
}

}  // namespace

TEST_CASE("a particle with constant angular velocity has the orientation of the closed form",
          "[granular][orientation]")
{
    const Four initial = of_rotation({0.3, -1.1, 0.7});
    const Vec3 axes[] = {{0.6, 0, 0.8}, {0, 0, -1}};
    // From 0.1 rad per step to rotations that single precision without compensation would lose, or
    // overestimate by a third
    for (const auto& [h, omega] : {std::tuple{1e-3, 100.}, {1e-4, 10.}, {1e-5, 4e-3}, {1e-5, 5e-4}}) {
        INFO("h " << h << ", omega " << omega);
        constexpr long steps = 30000;
        World world = empty(with_orientation(h));
        for (const Vec3& axis : axes)
            world.add(Particle{.r = 0.1 * axis, .radius = 0.05, .omega = omega * axis, .e = initial});
        world.step(steps);
        for (const int k : {0, 1}) {
            const Four e = world.particles()[k].e;
            const double turned = omega * h * static_cast<double>(steps);
            // the rotation of one step has single precision
            CHECK(between(e, product(of_rotation(turned * axes[k]), initial)) < 3e-7 * turned + 1e-9);
        }
    }
}

TEST_CASE("Euler parameters are rotated by any angle and keep unit length", "[granular][orientation]")
{
    for (const double chi : {1e-6, 0.02, 1., 3., 3.2, 7., 40.})
        for (const Vec3& axis : {Vec3{0.6, 0, 0.8}, Vec3{-0.28, 0.96, 0}}) {
            INFO("chi " << chi);
            const Four p = of_rotation({0.3, -1.1, 0.7}), turned = product(of_rotation(chi * axis), p);
            const auto d = granular::rotation_increment<double>(chi * axis, {p[0], {p[1], p[2], p[3]}});
            const double truncation = std::pow(std::min(chi, 3.2) / 2, 14) / 87178291200;
            CHECK(between({p[0] + d.e0, p[1] + d.e.x, p[2] + d.e.y, p[3] + d.e.z}, turned) <
                  4 * truncation + 1e-14);

            // repeatedly in single precision, from Euler parameters that are not normalised
            granular::EulerParameters<float> q{0.9f, {0, 0.1f, 0}};
            for (int k = 0; k < 10000; ++k) {
                const auto step = granular::rotation_increment<float>(
                    {float(chi * axis.x), float(chi * axis.y), float(chi * axis.z)}, q);
                q.e0 += step.e0, q.e += step.e;
            }
            CHECK(std::abs(double(q.e0) * q.e0 + double(q.e.x) * q.e.x + double(q.e.y) * q.e.y +
                           double(q.e.z) * q.e.z - 1) < 1e-6);
        }
}

TEST_CASE(
    "orientations of a rolling ball agree with the closed form and with double precision in all schemes",
    "[granular][orientation]")
{
    // a ball that slides and then rolls on a floor, about an axis that is not a coordinate axis
    constexpr double R = 0.05, v = 1;
    const Vec3 direction{0.8, 0.6, 0}, axis{-0.6, 0.8, 0};
    PairLaw law;
    law.normal = granular::Hooke{.k_n = 2e4, .gamma_n = 200};
    law.tangential = granular::Mindlin{.spring = {.k_t = 1e4f, .c = 0, .gamma_t = 100}, .cap = {0.3f, 0.3f}};
    const double m = 0.5, g = 9.81, mu = 0.3, slides = 2 * v / (7 * mu * g), T = 0.3;
    // α = 5 μ g/(2 R) while it slides; then it rolls with ω = (5/7) v/R
    const double angle = 2.5 * mu * g / R * slides * slides / 2 + 5. / 7 * v / R * (T - slides);
    for (const Scheme scheme : {Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::forward_euler,
                                Scheme::extended_taylor, Scheme::chung}) {
        INFO("scheme " << static_cast<int>(scheme));
        WorldOptions o = with_orientation(2e-5);
        o.gravity = {0, 0, -g}, o.scheme = scheme;
        const Particle ball{.r = {0, 0, R - m * g / 2e4}, .radius = R, .v = v * direction, .mass = m};
        World world(o, {soft()});
        world.set_law(0, 0, law);
        world.add(Boundary{}), world.add(ball);
        DoubleWorld in_double(o, law);
        in_double.particle = {ball}, in_double.boundary = {Boundary{}};
        const long steps = std::lround(T / o.h);
        world.step(steps), in_double.step(steps);
        const Particle p = world.particles()[0];
        CHECK(between(p.e, of_rotation(angle * axis)) <
              2e-3 * angle);  // the tangential spring delays the onset of sliding
        CHECK(between(p.e, in_double.particle[0].e) < 1e-4 * angle);
        // from then on the rotation is the rolled distance over R
        world.step(steps);
        const Particle q = world.particles()[0];
        CHECK(between(q.e, product(of_rotation(((q.r - p.r).norm() / R) * axis), p.e)) < 1e-4 * angle);
    }
}

TEST_CASE("an orientation stays with its particle when particles are sorted, saved, loaded and added",
          "[granular][orientation]")
{
    WorldOptions o = with_orientation(2e-5);
    o.low = {0, 0, 0}, o.high = {0.03, 0.03, 0.03};
    o.periodic = {true, true, true};
    const auto make = [&] {
        World world = empty(o);
        for (int k = 0; k < 60; ++k) {
            const double a = k;
            world.add(Particle{.r = 0.0075 * Vec3{k % 4 + 0.5, k / 4 % 4 + 0.5, k / 16 % 4 + 0.5},
                               .radius = 1e-3,
                               .v = {std::sin(a), std::cos(2 * a), std::sin(3 * a)},
                               .omega = 50 * Vec3{std::cos(a), std::sin(5 * a), std::cos(7 * a)},
                               .e = of_rotation({a, -a, 0.1 * a})});
        }
        return world;
    };
    const auto orientations = [](const World& world) {
        std::vector<Four> all;
        for (const Particle& p : world.particles()) all.push_back(p.e);
        return all;
    };
    World world = make();
    const auto begin = world.particles();
    const auto turning_on = [&](const std::vector<Particle>& from, double t) {
        double most = 0;
        const auto all = world.particles();
        for (std::size_t k = 0; k < from.size(); ++k)
            if ((all[k].omega - from[k].omega).norm() == 0)  // particles without a contact
                most = std::max(most, between(all[k].e, product(of_rotation(t * from[k].omega), from[k].e)));
        return most;
    };
    world.step(150);
    CHECK(world.rebuilds() > 5);
    CHECK(turning_on(begin, 150 * o.h) < 1e-7);
    const std::string bytes = world.to_bytes("run");
    World loaded = make();
    loaded.from_bytes(bytes, "run", "file");
    CHECK(orientations(loaded) == orientations(world));
    world.step(100), loaded.step(100);
    CHECK(orientations(loaded) == orientations(world));

    const auto before = world.particles();
    const Four new_one = of_rotation({0, 2, 0});
    const auto id = world.add(Particle{.r = {0.015, 0.015, 0.0285}, .radius = 4e-4, .e = new_one});
    world.step(0);
    CHECK(between(world.particles()[id].e, new_one) < 1e-15);
    for (std::size_t k = 0; k < before.size(); ++k)
        CHECK(between(world.particles()[k].e, before[k].e) < 1e-14);
}

TEST_CASE("an orientation is rejected if it is not a unit vector or if the world stores none",
          "[granular][orientation]")
{
    WorldOptions o = with_orientation(1e-5);
    World world = empty(o);
    const Particle p{.r = {0, 0, 0}, .radius = 0.05, .e = {1, 0.1, 0, 0}};
    CHECK_THROWS_WITH(world.add(p),
                      Catch::Contains("Euler parameters must have the length 1 within 1e-3, got 1.00498"));
    o.orientation = false;
    World without = empty(o);
    CHECK_THROWS_WITH(without.add(Particle{.r = {0, 0, 0}, .radius = 0.05, .e = {0, 1, 0, 0}}),
                      Catch::Contains("requires a world that integrates orientations"));
    without.add(Particle{.r = {0, 0, 0}, .radius = 0.05, .omega = {1, 0, 0}});
    without.step(100);
    CHECK(without.particles()[0].e == Particle().e);
}
