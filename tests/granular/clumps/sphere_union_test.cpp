// SPDX-License-Identifier: GPL-3.0-or-later
// Mass properties of unions of spheres: closed forms, and independence of orientation and of hidden spheres.
#include "granular/backend/split_mix.hpp"
#include "granular/clumps/clump_template.hpp"
#include "granular/core/rigid_body.hpp"
#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using granular::Inertia;
using granular::MassProperties;
using granular::Random;
using granular::rotated;
using granular::Sphere;
using granular::sphere_union;
using granular::turned;
using granular::Vec3;

namespace {

constexpr double pi = std::numbers::pi;

std::vector<Sphere> random_spheres(std::uint64_t seed, int count)
{
    Random random(seed);
    std::vector<Sphere> all;
    for (int k = 0; k < count; ++k)
        all.push_back(
            {{random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)}, random.number(0.3, 0.9)});
    return all;
}

/// Largest difference of two results over the size of the second one
double difference(const MassProperties& a, const MassProperties& b)
{
    double largest = std::max(std::abs(a.volume / b.volume - 1), (a.centre - b.centre).norm());
    for (int k = 0; k < 6; ++k) largest = std::max(largest, std::abs(a.J[k] - b.J[k]) / b.J[0]);
    return largest;
}

}  // namespace

TEST_CASE("spheres without overlaps have the sums of their closed forms", "[granular][clumps]")
{
    const double R = 0.7;
    const MassProperties one = sphere_union({{{1, 2, 3}, R}});
    CHECK(one.volume == 4.0 / 3 * pi * R * R * R);
    CHECK(one.centre == Vec3{1, 2, 3});
    CHECK(one.J[0] == Approx(0.4 * one.volume * R * R).epsilon(1e-15));
    const MassProperties two = sphere_union({{{0, 0, 1}, 0.5}, {{0, 0, -1}, 0.5}});
    const double V = 4.0 / 3 * pi / 8;
    CHECK(two.volume == Approx(2 * V).epsilon(1e-14));
    CHECK(two.J[2] == Approx(2 * 0.4 * V * 0.25).epsilon(1e-14));
    CHECK(two.J[0] == Approx(2 * V * (0.1 + 1)).epsilon(1e-14));
    CHECK(std::abs(two.J[3]) < 1e-14);
}

TEST_CASE("two equal overlapping spheres have the closed form of two spherical caps", "[granular][clumps]")
{
    // Each half is a sphere of radius R around (0, 0, a) above z = 0: V = π ∫ (R² - (z - a)²) dz.
    const double a = GENERATE(1e-6, 0.1, 0.5, 0.99), R = 1;
    const Vec3 direction = (1 / 3.) * Vec3{1, 2, -2};
    const MassProperties m = sphere_union({{a * direction, R}, {-a * direction, R}});
    double V = 0, along = 0, across = 0;  // ∫ dV, ∫ z² dV, ∫ x² dV, by polynomials of z - a = s
    const auto power = [&](int n) { return (std::pow(R, n) - std::pow(-a, n)) / n; };  // ∫ s^(n-1) ds
    V = 2 * pi * (R * R * power(1) - power(3));
    along = 2 * pi *
            (R * R * (power(3) + 2 * a * power(2) + a * a * power(1)) -
             (power(5) + 2 * a * power(4) + a * a * power(3)));
    across = 2 * pi / 4 * (R * R * R * R * power(1) - 2 * R * R * power(3) + power(5));
    CHECK(m.volume == Approx(V).epsilon(1e-12));
    CHECK(m.centre.norm() < 1e-12);
    const Inertia J(m.J);
    CHECK(direction.dot(J * direction) == Approx(2 * across).epsilon(1e-12));
    const Vec3 normal = (1 / std::sqrt(5.)) * Vec3{2, -1, 0};
    CHECK(normal.dot(J * normal) == Approx(across + along).epsilon(1e-12));
}

TEST_CASE("the mass properties of a union do not depend on the orientation of the spheres",
          "[granular][clumps]")
{
    const auto seed = GENERATE(1, 2, 3, 4, 5, 6);
    const std::vector<Sphere> spheres = random_spheres(static_cast<std::uint64_t>(seed), 2 + 2 * seed);
    const MassProperties expected = sphere_union(spheres);
    Random random(17);
    for (int k = 0; k < 4; ++k) {
        const auto p = turned({1, {0, 0, 0}}, random.number(0, 3) * random.direction());
        const Vec3 shift{1, -2, 0.5};
        std::vector<Sphere> moved = spheres;
        for (Sphere& s : moved) s.r = shift + rotated(p, s.r);
        const MassProperties m = sphere_union(moved);
        INFO(seed << ' ' << m.volume << ' ' << expected.volume);
        CHECK(std::abs(m.volume / expected.volume - 1) < 1e-10);
        CHECK((m.centre - shift - rotated(p, expected.centre)).norm() < 1e-10);
        const Inertia J(m.J), J_0(expected.J);
        for (const Vec3& e : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
            CHECK((J * rotated(p, e) - rotated(p, J_0 * e)).norm() < 1e-10 * J_0.xx);
    }
}

TEST_CASE("the mass properties of a union agree with those of random points", "[granular][clumps]")
{
    const std::vector<Sphere> spheres = random_spheres(9, 8);
    const MassProperties m = sphere_union(spheres);
    Random random(5);
    const int n = 400000;
    double inside = 0, xx = 0, xy = 0;
    Vec3 first{0, 0, 0};
    for (int k = 0; k < n; ++k) {
        const Vec3 x{random.number(-2, 2), random.number(-2, 2), random.number(-2, 2)};
        const bool in = std::any_of(spheres.begin(), spheres.end(),
                                    [&](const Sphere& s) { return (x - s.r).norm() < s.radius; });
        if (!in) continue;
        const Vec3 d = x - m.centre;
        inside += 1, first += d, xx += d.y * d.y + d.z * d.z, xy -= d.x * d.y;
    }
    const double cell = 64. / n, deviation = std::sqrt(inside) * cell;  // of the volume
    CHECK(inside * cell == Approx(m.volume).margin(4 * deviation));
    CHECK(first.norm() * cell < 6 * deviation);
    CHECK(xx * cell == Approx(m.J[0]).margin(8 * deviation));
    CHECK(xy * cell == Approx(m.J[3]).margin(8 * deviation));
}

TEST_CASE("spheres within others and repeated spheres do not change a union", "[granular][clumps]")
{
    const std::vector<Sphere> three = random_spheres(3, 3);
    const MassProperties expected = sphere_union(three);
    std::vector<Sphere> more = three;
    more.push_back(three[1]);
    more.push_back({three[0].r + Vec3{0.01, 0, 0.02}, three[0].radius - 0.1});
    CHECK(difference(sphere_union(more), expected) < 1e-10);
    CHECK(difference(sphere_union({three[0], three[0]}), sphere_union({three[0]})) < 1e-12);
}

TEST_CASE("principal axes make the inertia diagonal", "[granular][clumps]")
{
    const std::array<double, 6> values =
        GENERATE(std::array{3., 4., 5., 0.4, -0.6, 0.7}, std::array{2., 2., 2., 0., 0., 0.},
                 std::array{1., 3., 2.5, 0., 0., 0.}, std::array{2., 2., 3., 0.5, 0., 0.});
    const Inertia J(values);
    const granular::PrincipalInertia p = principal_inertia(J);
    const double moments[] = {p.moment.x, p.moment.y, p.moment.z};
    const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; ++k) {
        const Vec3 e = rotated(p.axes, axes[k]);
        CHECK((J * e - moments[k] * e).norm() < 1e-12 * J.xx);
    }
    if (J.xy == 0 && J.yz == 0 && J.zx == 0) CHECK(p.axes.e == Vec3{0, 0, 0});
}

TEST_CASE("invalid templates of clumps are refused with the value", "[granular][clumps]")
{
    using Catch::Matchers::Equals;
    CHECK_THROWS_WITH(granular::solid_clump("a", {}, 2500),
                      Equals("clump 'a': must have at least one sphere, got 0"));
    CHECK_THROWS_WITH(granular::solid_clump("a", {{{0, 0, 0}, 1}, {{0, 0, 0}, 0}}, 2500),
                      Equals("clump 'a', sphere 1: the radius must be positive, got 0"));
    CHECK_THROWS_WITH(granular::solid_clump("a", {{{0, NAN, 0}, 1}}, 2500),
                      Equals("clump 'a', sphere 0: the centre must be finite, got nan"));
    CHECK_THROWS_WITH(granular::solid_clump("a", {{{0, 0, 0}, 1}}, 0),
                      Equals("clump 'a': the mass must be positive, got 0"));
    granular::ClumpTemplate t = granular::solid_clump("a", {{{0, 0, 0}, 1}}, 2500);
    t.inertia = Inertia(std::array{1., 1., 3., 0., 0., 0.});
    CHECK_THROWS_AS(t.check(), io::InvalidInput);
    CHECK_THROWS_WITH(granular::solid_clump("a", std::vector<Sphere>(257, {{0, 0, 0}, 1}), 2500),
                      Equals("clump 'a': must not have more than 256 spheres, got 257"));
}
