// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid body boundaries: free tops in closed form, partly free rotation, and tools among particles.
#include "granular/core/rigid_body.hpp"

#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::EulerParameters;
using granular::Inertia;
using granular::rotated;
using granular::Scheme;
using granular::turned;

namespace {

/// A body of 1 kg with this inertia, orientation and angular velocity
Boundary body(const std::array<double, 6>& J, const Vec3& rotation, const Vec3& omega)
{
    Boundary b;
    b.shape = Boundary::Shape::sphere, b.radius = 1e-3, b.mass = 1, b.inertia = J;
    b.p = turned({1, {0, 0, 0}}, rotation), b.omega = omega;
    return b;
}

void turn(Boundary& b, double h, long steps)
{
    for (; steps > 0; --steps) rotate(b, mean_omega(b, h), h);
}

/// Rotation angle between two orientations [rad]
double angle(const EulerParameters<double>& p, const EulerParameters<double>& q)
{
    const Vec3 e = p.e0 * q.e - q.e0 * p.e - p.e.cross(q.e);
    return 2 * std::asin(std::min(1., e.norm()));
}

double order(double error, double error_of_half) { return std::log2(error / error_of_half); }

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
    world.set_law(0, 0, hertz_mindlin(glass(), 0.6, 0.4));
    return world;
}

const std::array<double, 6> full = {3e-3, 4e-3, 5e-3, 4e-4, -6e-4, 7e-4};

}  // namespace

TEST_CASE("a free symmetric top converges to its closed form at order 2", "[granular][tool]")
{
    // A(t) = exp(t L/J_1) A_0 exp(t (1 - J_3/J_1) ω̄_3 e_3): precession about L and spin about the own axis
    const double scale = GENERATE(1., 1e-9);
    const double J1 = 4e-3 * scale, J3 = 1.5e-3 * scale, t = 1;
    const Boundary start = body({J1, J1, J3, 0, 0, 0}, {0.3, -0.8, 0.4}, {2, -1, 3});
    const Vec3 L = angular_momentum(start);
    const double spin = (1 - J3 / J1) * rotated_back(start.p, start.omega).z;
    const EulerParameters<double> own = turned({1, {0, 0, 0}}, {0, 0, t * spin});
    const EulerParameters<double>& p = start.p;
    const EulerParameters<double> turned_first = {p.e0 * own.e0 - p.e.dot(own.e),
                                                  p.e0 * own.e + own.e0 * p.e + p.e.cross(own.e)};
    const EulerParameters<double> expected = turned(turned_first, (t / J1) * L);
    const Vec3 axis = rotated(expected, {0, 0, 1});
    const Vec3 omega = (1 / J1) * L + rotated_back(start.p, start.omega).z * (1 - J3 / J1) * axis;

    std::vector<double> errors, of_omega;
    for (const long steps : {100, 200, 400, 800}) {
        Boundary b = start;
        turn(b, t / double(steps), steps);
        errors.push_back(angle(b.p, expected)), of_omega.push_back((b.omega - omega).norm());
        CHECK((angular_momentum(b) - L).norm() < 1e-13 * L.norm());
    }
    for (std::size_t k = 1; k < errors.size(); ++k) {
        INFO(errors[k - 1] << ' ' << errors[k] << ' ' << of_omega[k]);
        CHECK(order(errors[k - 1], errors[k]) == Approx(2).margin(0.05));
        CHECK(order(of_omega[k - 1], of_omega[k]) == Approx(2).margin(0.05));
    }
}

TEST_CASE("a free top of three different moments keeps momentum to rounding and energy without drift",
          "[granular][tool]")
{
    // The rotation about the middle axis is unstable, and the body turns over again and again.
    Boundary b = body({1e-3, 2e-3, 2.8e-3, 0, 0, 0}, {0.2, 0.1, -0.7}, {0, 0, 0});
    b.omega = rotated(b.p, {0.01, 5, 0.01});
    const Vec3 L = angular_momentum(b);
    const double E = kinetic_energy(b);
    double early = 0, late = 0;
    int turns = 0;
    double last = 1;
    for (int k = 0; k < 200; ++k) {
        turn(b, 2e-3, 100);
        double& largest = k < 100 ? early : late;
        largest = std::max(largest, std::abs(kinetic_energy(b) / E - 1));
        const double along = rotated_back(b.p, L).y;
        turns += along * last < 0;
        last = along;
    }
    CHECK(turns >= 6);
    CHECK((angular_momentum(b) - L).norm() < 1e-12 * L.norm());
    CHECK(early < 1e-4);
    CHECK(late < 1.1 * early);
}

TEST_CASE("a step forwards and a step backwards of a free top cancel", "[granular][tool]")
{
    const Boundary start = body(full, {0.5, 0.2, -1}, {20, -30, 10});
    Boundary b = start;
    turn(b, 0.01, 50), turn(b, -0.01, 50);
    CHECK(angle(b.p, start.p) < 1e-12);
    CHECK((b.omega - start.omega).norm() < 1e-11);
}

TEST_CASE("a body that is free about one axis accelerates by the moment of inertia about it",
          "[granular][tool]")
{
    Boundary b = body(full, {0.4, 0.7, -0.3}, {0, 0, 0});
    b.free = {false, false, false, false, true, false};
    const double J = Vec3{0, 1, 0}.dot(rotated(b.p, b.inertia * rotated_back(b.p, {0, 1, 0})));
    const double h = 1e-3;
    for (int k = 0; k < 1000; ++k) {
        accelerate(b, {1, 1, 1}, {5e-3, 2e-3, -3e-3}, {0, 0, -9.81}, h);
        rotate(b, mean_omega(b, h), h);
    }
    CHECK(b.omega.y == Approx(2e-3 / J).epsilon(1e-12));
    CHECK(b.omega.x == 0);
    CHECK(b.omega.z == 0);
    CHECK(b.v == Vec3{0, 0, 0});
}

TEST_CASE("a prescribed rotation turns a body that is free about the other axes by its momenta",
          "[granular][tool]")
{
    // Free about x and y, the rotation about z is prescribed: L_x and L_y stay the same.
    Boundary b = body(full, {0.4, 0.7, -0.3}, {1, 2, 0.5});
    b.free = {true, true, true, true, true, false};
    const Vec3 L = angular_momentum(b);
    const double h = 1e-3;
    for (int k = 0; k < 1000; ++k) {
        prescribe_omega(b, {0, 0, 0.5 + 1e-3 * k});
        rotate(b, mean_omega(b, h), h);
    }
    const Vec3 now = angular_momentum(b);
    CHECK(std::abs(now.x - L.x) < 1e-12 * L.norm());
    CHECK(std::abs(now.y - L.y) < 1e-12 * L.norm());
    CHECK(std::abs(now.z - L.z) > 1e-2 * L.norm());
    CHECK(b.omega.z == Approx(0.5 + 0.999).epsilon(1e-14));
}

TEST_CASE("a body that turns by more than the iteration allows is refused with the boundary and the time",
          "[granular][tool]")
{
    World world = glass_world(room(1e-3));
    world.add(body({1e-3, 2e-3, 2.8e-3, 0, 0, 0}, {0, 0, 0}, {1000, 1500, 2000}));
    CHECK_THROWS_WITH(world.step(1), Catch::Contains("boundary 0 turns by 2.69 rad in one step") &&
                                         Catch::Contains("t = 0 s"));
}

TEST_CASE("a ball with the mass of a particle moves as the particle does", "[granular][tool]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    const double R = 1e-3;
    const Vec3 v{0.1, 0.05, -0.5}, omega{30, -20, 60};
    const auto run = [&](bool is_tool) {
        WorldOptions o = room(1e-6, scheme);
        o.gravity = {0.3, -0.2, -9.81};
        World world = glass_world(o);
        if (is_tool) {
            Boundary ball;
            ball.shape = Boundary::Shape::sphere, ball.radius = R, ball.r = {0, 0, 2.3 * R};
            ball.mass = 4. / 3 * std::numbers::pi * R * R * R * 2500, ball.inertia = 0.4 * ball.mass * R * R;
            ball.v = v, ball.omega = omega;
            world.add(ball);
        }
        world.add(Particle{.r = {0.2 * R, 0.1 * R, 0}, .radius = R});
        if (!is_tool) world.add(Particle{.r = {0, 0, 2.3 * R}, .radius = R, .v = v, .omega = omega});
        world.step(1500);
        const auto all = world.particles();
        if (!is_tool) return std::pair{all[0], all[1]};
        const Boundary& b = world.boundary(0);
        Particle ball;
        ball.r = b.r, ball.v = b.v, ball.omega = b.omega;
        return std::pair{all[0], ball};
    };
    const auto [a, ball] = run(true);
    const auto [b, particle] = run(false);
    CHECK(a.v.norm() > 0.3);
    CHECK((a.v - b.v).norm() < 3e-6 * a.v.norm());
    CHECK((ball.v - particle.v).norm() < 3e-6 * v.norm());
    // The contact point of a boundary is on its surface, that of two particles is half the overlap below.
    CHECK((a.omega - b.omega).norm() < 5e-5 * a.omega.norm());
    CHECK((ball.omega - particle.omega).norm() < 5e-5 * omega.norm());
    CHECK((ball.r - particle.r).norm() < 1e-8 * R / 1e-3);
}

TEST_CASE("tools under loads that change with time converge at the order of the scheme", "[granular][tool]")
{
    const auto [scheme, expected] =
        GENERATE(table<Scheme, double>({{Scheme::symplectic_euler, 1}, {Scheme::velocity_verlet, 2}}));
    const auto end = [s = scheme](int steps) {
        World world = glass_world(room(0.1 / steps, s));
        Boundary b = body(full, {0.4, 0.7, -0.3}, {3, -2, 5});
        world.add(b);
        const double of_loads = s == Scheme::velocity_verlet ? 0.05 / steps : 0;
        world.before_each_step([=](World& w) {
            const double t = w.t() + of_loads;
            w.boundary(0).F = {std::cos(20 * t), 0, 0.1};
            w.boundary(0).T = {0.1 * std::sin(30 * t), 0.2, -0.1 * std::cos(20 * t)};
        });
        world.step(steps);
        return world.boundary(0);
    };
    const Boundary a = end(100), b = end(200), c = end(400);
    CHECK(order(angle(a.p, b.p), angle(b.p, c.p)) == Approx(expected).margin(0.05));
    CHECK(order((a.omega - b.omega).norm(), (b.omega - c.omega).norm()) == Approx(expected).margin(0.05));
    CHECK(order((a.r - b.r).norm(), (b.r - c.r).norm()) == Approx(expected).margin(0.05));
}

TEST_CASE("particles and a tool of triangles conserve momentum and angular momentum",
          "[granular][tool][mesh]")
{
    WorldOptions o = room(1e-6);
    World world(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.9, 0.3);
    law.lever = granular::Lever::contact;
    world.set_law(0, 0, law);
    const granular::TriangleMesh mesh =
        granular::box_mesh({-4e-3, -3e-3, -1e-3}, {4e-3, 3e-3, 1e-3}, {}, false, 1e-3);
    const granular::MassProperties solid = granular::mass_properties(mesh);
    std::array<double, 6> J = solid.J;
    for (double& x : J) x *= 1000;
    Boundary tool;
    tool.shape = Boundary::Shape::mesh, tool.mass = 1000 * solid.volume, tool.inertia = J;
    tool.omega = {20, 10, -30}, tool.p = turned({1, {0, 0, 0}}, {0.3, 0.2, 0.5});
    world.add(tool, mesh);
    for (int k = 0; k < 9; ++k)
        world.add(Particle{.r = {2.5e-3 * (k % 3 - 1), 2.5e-3 * (k / 3 - 1), 6e-3},
                           .radius = 1e-3,
                           .v = {0.1, -0.05 * k, -1},
                           .omega = {0, 0, 100. * k}});
    struct Momenta {
        Vec3 P, L;
    };
    const auto momenta = [&] {
        const Boundary& b = world.boundary(0);
        Momenta m{b.mass * b.v, angular_momentum(b) + b.mass * b.r.cross(b.v)};
        for (const Particle& p : world.particles()) {
            m.P += p.mass * p.v;
            m.L += p.mass * p.r.cross(p.v) + 0.4 * p.mass * p.radius * p.radius * p.omega;
        }
        return m;
    };
    const Momenta before = momenta();
    world.step(8000);
    const Momenta after = momenta();
    CHECK(world.boundary(0).v.norm() > 0.05);
    CHECK((after.P - before.P).norm() < 1e-6 * before.P.norm());
    CHECK((after.L - before.L).norm() < 1e-5 * before.L.norm());
}
