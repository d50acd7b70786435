// SPDX-License-Identifier: GPL-3.0-or-later
// Lever arms of the tangential force: the radii, or the distances of the centres from a point within the
// overlap.
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::ContactPoint;
using granular::ContactRecord;
using granular::ContactVelocities;
using granular::DoubleWorld;
using granular::Lever;

namespace lever_test {

namespace {

constexpr double R = 1e-3, h = 1e-6;

PairLaw law_with(Lever lever)
{
    PairLaw law = hertz_mindlin(glass(), 0.8, 0.3);
    law.lever = lever;
    return law;
}

WorldOptions space()
{
    WorldOptions o;
    o.low = {-20 * R, -20 * R, -20 * R}, o.high = {20 * R, 20 * R, 20 * R};
    o.gravity = {0, 0, 0}, o.h = h;
    return o;
}

Vec3 spin(const Particle& p) { return 0.4 * p.mass * p.radius * p.radius * p.omega; }

/// Two spheres of different size that collide obliquely
std::vector<Particle> colliding_pair()
{
    return {{.r = {0, 0, 0}, .radius = R, .v = {0.4, 0.1, 0.6}, .omega = {100, 0, 50}, .mass = 1e-5},
            {.r = {0.3 * R, 0, 2.72 * R},
             .radius = 1.7 * R,
             .v = {0, -0.3, 0},
             .omega = {0, 80, 0},
             .mass = 4e-5}};
}
Vec3 angular_momentum(const std::vector<Particle>& all)
{
    Vec3 L{0, 0, 0};
    for (const Particle& p : all) L += p.mass * p.r.cross(p.v) + spin(p);
    return L;
}

}  // namespace

TEST_CASE("with the lever arms to the contact point a common rotation of a pair is no sliding",
          "[granular][lever]")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in(-1, 1);
    const auto vector = [&] { return Vec3{in(random), in(random), in(random)}; };
    for (int k = 0; k < 20; ++k) {
        const Vec3 omega = vector(), r_i = vector(), r_j = vector();
        const double apart = (r_i - r_j).norm();
        ContactPoint<double> contact{};
        contact.n = (1 / apart) * (r_i - r_j), contact.delta = 0.05 * apart;
        contact.R_i = 0.4 * apart, contact.R_j = 0.65 * apart;  // R_i + R_j - delta = the distance
        const ContactVelocities<double> of{omega.cross(r_i) - omega.cross(r_j), omega, omega};
        set_rates(contact, of, Lever::radius);
        CHECK(contact.v_t.norm() == Approx(0.05 * apart * omega.cross(contact.n).norm()).epsilon(1e-9));
        set_rates(contact, of, Lever::contact);
        CHECK(contact.v_t.norm() < 1e-14);
    }
}

TEST_CASE("with the lever arms to the contact point the angular momentum of a pair is conserved",
          "[granular][lever]")
{
    for (const Lever lever : {Lever::radius, Lever::contact}) {
        DoubleWorld in_double(space(), law_with(lever));
        in_double.particle = colliding_pair();
        const double before = angular_momentum(in_double.particle).norm();
        World world(space(), {glass()});
        world.set_law(0, 0, law_with(lever));
        for (const Particle& p : colliding_pair()) world.add(p);
        in_double.step(1000), world.step(1000);
        REQUIRE(world.contacts().empty());
        const auto change = [&](const std::vector<Particle>& now) {
            return (angular_momentum(now) - angular_momentum(colliding_pair())).norm() / before;
        };
        CAPTURE(static_cast<int>(lever), before);
        if (lever == Lever::contact) {
            CHECK(change(in_double.particle) < 1e-13);
            CHECK(change(world.particles()) < 1e-6);
        } else {
            CHECK(change(in_double.particle) > 1e-4);  // overlap times friction
        }
        for (std::size_t k = 0; k < 2; ++k) {
            CHECK((world.particles()[k].v - in_double.particle[k].v).norm() < 1e-5);
            CHECK((world.particles()[k].omega - in_double.particle[k].omega).norm() < 2e-2);  // of 200 rad/s
        }
    }
}

TEST_CASE("force and point of application of a contact record give the torques on both bodies",
          "[granular][lever]")
{
    World world(space(), {glass()});
    world.set_law(0, 0, law_with(Lever::contact));
    Boundary plate;
    plate.r = {2 * R, 0, -1.2 * R}, plate.mass = 1e-4, plate.inertia = 1e-10;
    world.add(plate);
    std::vector<Particle> pair = colliding_pair();
    pair[1].v.z = -0.1;
    for (const Particle& p : pair) world.add(p);
    int of_pair = 0, of_plate = 0;
    for (int k = 0; k < 1500; ++k) {
        world.step();
        const auto contacts = world.contacts();
        const auto now = world.particles();
        const Vec3 plate_before = world.boundary(0).omega, r_plate = world.boundary(0).r;
        if (contacts.size() != 1) continue;
        const ContactRecord c = contacts[0];
        if (c.boundary) {
            ++of_plate;
            CHECK((c.C - now[c.i].r).norm() == Approx(R - c.delta / 2).epsilon(1e-5));
            const auto wrench = world.wrench(0);
            CHECK((wrench.T + (c.C - r_plate).cross(c.F)).norm() <= 1e-12 * wrench.T.norm());
        } else {
            ++of_pair;
            CHECK((c.C - now[c.i].r).norm() + (c.C - now[c.j].r).norm() ==
                  Approx(2.7 * R - c.delta).epsilon(1e-6));
            CHECK((c.C - now[c.i].r).norm() * 1.7 == Approx((c.C - now[c.j].r).norm()).epsilon(1e-5));
        }
        // the next step advances the angular velocities by the torques of the record
        world.step();
        const auto then = world.particles();
        const auto torque = [&](std::size_t p) {
            const double inertia = 0.4 * now[p].mass * now[p].radius * now[p].radius;
            return (inertia / h) * (then[p].omega - now[p].omega);
        };
        const double scale = R * c.F.norm();
        CHECK((torque(c.i) - (c.C - now[c.i].r).cross(c.F)).norm() < 1e-4 * scale);
        if (c.boundary)
            CHECK((1e-10 / h * (world.boundary(0).omega - plate_before) + (c.C - r_plate).cross(c.F)).norm() <
                  1e-4 * scale);
        else
            CHECK((torque(c.j) + (c.C - now[c.j].r).cross(c.F)).norm() < 1e-4 * scale);
    }
    CHECK(of_pair > 20);
    CHECK(of_plate > 20);
}

}  // namespace lever_test
