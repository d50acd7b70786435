// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries: signed distance, normal and velocity.
#include "granular/core/boundary.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace hilda::granular;

namespace boundary_test {

namespace {

constexpr double pi = std::numbers::pi;

struct Random {
    std::mt19937 engine;
    double number(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
};

Vec3 unit(const Vec3& a) { return (1 / a.norm()) * a; }

/// Two unit vectors normal to the axis and to each other
std::pair<Vec3, Vec3> across(const Vec3& axis)
{
    const Vec3 u = unit(axis.cross(std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    return {u, axis.cross(u)};
}

Boundary made(Boundary::Shape shape, bool inside, double half_angle = 0)
{
    Boundary b;
    b.shape = shape, b.inside = inside ? 1 : 0;
    b.r = {0.3, -0.2, 0.1}, b.axis = unit({1, -2, 1.5});
    b.radius = 0.7, b.cosine = std::cos(half_angle), b.sine = std::sin(half_angle);
    b.v = {0.4, -1, 0.3}, b.omega = {1.5, 0.7, -2};
    return b;
}

std::vector<std::pair<std::string, Boundary>> all()
{
    using Shape = Boundary::Shape;
    return {{"plane", made(Shape::plane, false)},
            {"around a cylinder", made(Shape::cylinder, false)},
            {"in a cylinder", made(Shape::cylinder, true)},
            {"around a narrow cone", made(Shape::cone, false, 0.3)},
            {"in a narrow cone", made(Shape::cone, true, 0.3)},
            {"around a wide cone", made(Shape::cone, false, 1.3)},
            {"in a wide cone", made(Shape::cone, true, 1.3)},
            {"around a sphere", made(Shape::sphere, false)},
            {"in a sphere", made(Shape::sphere, true)}};
}

/// Parametrisation of the surface, s and t in [-1, 1]
Vec3 surface(const Boundary& b, double s, double t)
{
    const auto [u, w] = across(b.axis);
    const Vec3 radial = std::cos(pi * s) * u + std::sin(pi * s) * w;
    switch (b.shape) {
        case Boundary::Shape::plane:
            return b.r + 4 * s * u + 4 * t * w;
        case Boundary::Shape::cylinder:
            return b.r + b.radius * radial + 4 * t * b.axis;
        case Boundary::Shape::cone:  // along a generator, from the apex on
            return b.r + 2 * (1 + t) * (b.sine * radial + b.cosine * b.axis);
        default:  // a sphere
            break;
    }
    return b.r + b.radius * (std::cos(pi / 2 * t) * radial + std::sin(pi / 2 * t) * b.axis);
}

/// Minimum of f on [-1, 1] by successive grid refinement; `round`: f is periodic
template <class F>
double least(const F& f, bool round)
{
    double best = 0, lowest = std::numeric_limits<double>::infinity();
    for (double wide = 1; wide > 1e-6; wide /= 3) {
        const double middle = best;
        for (int k = -8; k <= 8; ++k) {
            const double at = middle + wide * k / 8, x = round ? at : std::clamp(at, -1., 1.), value = f(x);
            if (value < lowest) lowest = value, best = x;
        }
    }
    return lowest;
}

/// Minimum distance to the surface: minimum over the meridians of the minimum along a meridian. Apices and
/// poles, where the parametrisation is singular, are found as well.
double least_distance(const Boundary& b, const Vec3& at)
{
    const auto on_meridian = [&](double s) {
        return least([&](double t) { return (surface(b, s, t) - at).norm(); }, false);
    };
    return least(on_meridian, b.shape != Boundary::Shape::plane);
}

/// Whether a point is on the side of the particles
bool on_the_side_of_particles(const Boundary& b, const Vec3& at)
{
    const Vec3 d = at - b.r;
    const double along = d.dot(b.axis), far = (d - along * b.axis).norm();
    switch (b.shape) {
        case Boundary::Shape::plane:
            return along > 0;
        case Boundary::Shape::cylinder:
            return (far < b.radius) == (b.inside != 0);
        case Boundary::Shape::cone:
            return (std::atan2(far, along) < std::atan2(b.sine, b.cosine)) == (b.inside != 0);
        default:  // a sphere
            break;
    }
    return (d.norm() < b.radius) == (b.inside != 0);
}

/// Whether the apex is the point of the cone that is closest to a point
bool at_tip(const Boundary& b, const Vec3& at)
{
    const Vec3 d = at - b.r;
    const double along = d.dot(b.axis), far = (d - along * b.axis).norm();
    return b.shape == Boundary::Shape::cone && along * b.cosine + far * b.sine < 0;
}

/// Random points around a boundary, and points near its axis behind r
std::vector<Vec3> points(const Boundary& b)
{
    Random random{std::mt19937(17)};
    std::vector<Vec3> at;
    for (int k = 0; k < 60; ++k) at.push_back(b.r + random.vector(1.2));
    for (const double back : {0.1, 0.6}) at.push_back(b.r - back * b.axis + random.vector(0.02));
    return at;
}

/// The boundary after a motion over dt, to first order in dt
Boundary moved(Boundary b, double dt)
{
    b.r += dt * b.v;
    b.axis = unit(b.axis + dt * b.omega.cross(b.axis));
    return b;
}

}  // namespace

TEST_CASE("the distance of a boundary is the minimum distance to its points", "[granular][shapes]")
{
    for (const auto& [name, b] : all()) {
        int of_tip = 0, beyond = 0;
        for (const Vec3& at : points(b)) {
            INFO(name << ", at " << at.x << " " << at.y << " " << at.z);
            // inside a cone, for points behind its apex, only the sign of the distance is specified
            if (b.inside != 0 && at_tip(b, at)) {
                CHECK(nearest(b, at).distance < 0);
                continue;
            }
            const double sign = on_the_side_of_particles(b, at) ? 1 : -1;
            // the grids end at 1e-6 m, with a quadratic error at a minimum; the apex lies on every meridian
            CHECK(nearest(b, at).distance == Approx(sign * least_distance(b, at)).margin(1e-7));
            of_tip += at_tip(b, at), beyond += sign < 0;
        }
        INFO(name);
        CHECK((of_tip > 2) == (b.shape == Boundary::Shape::cone && b.inside == 0));
        CHECK(beyond > 0);
    }
}

TEST_CASE("the normal of a boundary is the gradient of the distance and points to the closest point",
          "[granular][shapes]")
{
    for (const auto& named : all())
        for (const Vec3& at : points(named.second)) {
            const auto& b = named.second;
            INFO(named.first << ", at " << at.x << " " << at.y << " " << at.z);
            const Nearest near = nearest(b, at);
            CHECK(near.n.norm() == Approx(1).epsilon(1e-14));
            constexpr double e = 1e-6;
            const auto slope = [&](const Vec3& direction) {
                return (nearest(b, at + e * direction).distance - nearest(b, at - e * direction).distance) /
                       (2 * e);
            };
            const Vec3 gradient = {slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
            CHECK((gradient - near.n).norm() < 1e-8);
            if (b.inside == 0 || !at_tip(b, at))
                CHECK(std::abs(nearest(b, at - near.distance * near.n).distance) < 1e-14);
        }
}

TEST_CASE("the distance of a boundary is exact on its axis", "[granular][shapes]")
{
    for (const auto& [name, b] : all()) {
        if (b.shape == Boundary::Shape::plane) continue;
        INFO(name);
        const bool sphere = b.shape == Boundary::Shape::sphere;
        const Vec3 at = b.r + (sphere ? 0 : 0.5) * b.axis;
        const double far = b.shape == Boundary::Shape::cone ? 0.5 * b.sine : b.radius;
        const Nearest near = nearest(b, at);
        CHECK(near.distance == Approx(b.inside != 0 ? far : -far).epsilon(1e-14));
        CHECK(near.n.norm() <= 1);  // the mean of the normals around the axis, not a unit vector and not NaN
    }
    Boundary cone = made(Boundary::Shape::cone, false, 0.3);
    CHECK(nearest(cone, cone.r - 0.5 * cone.axis).distance == Approx(0.5).epsilon(1e-14));
    CHECK((nearest(cone, cone.r - 0.5 * cone.axis).n + cone.axis).norm() < 1e-14);
    CHECK(nearest(cone, cone.r).distance == Approx(0).margin(1e-15));
}

TEST_CASE("the velocity of a boundary is the velocity of its material points", "[granular][shapes]")
{
    for (const auto& [name, b] : all()) {
        constexpr double dt = 1e-5;
        for (const Vec3& at : points(b)) {
            INFO(name << ", at " << at.x << " " << at.y << " " << at.z);
            // a material point of the boundary, translated with r and rotated about omega
            const Vec3 axis = unit(b.omega), d = at - b.r;
            const auto material_point = [&, &b = b](double t) {
                const double angle = b.omega.norm() * t;
                return b.r + t * b.v + d.dot(axis) * axis + std::cos(angle) * (d - d.dot(axis) * axis) +
                       std::sin(angle) * axis.cross(d);
            };
            CHECK((velocity(b, at) - (1 / (2 * dt)) * (material_point(dt) - material_point(-dt))).norm() <
                  1e-8);

            // the rate of the distance of a fixed point is the normal velocity of the closest point
            if (b.inside != 0 && at_tip(b, at)) continue;
            const Nearest near = nearest(b, at);
            const double rate =
                (nearest(moved(b, dt), at).distance - nearest(moved(b, -dt), at).distance) / (2 * dt);
            CHECK(rate == Approx(-near.n.dot(velocity(b, at - near.distance * near.n))).margin(2e-8));
        }
    }
}

}  // namespace boundary_test
