// SPDX-License-Identifier: GPL-3.0-or-later
// The balance of momentum of coarse-grained fields.
#include "granular/fields/field_input.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace hilda::granular;
using namespace hilda::tests;

namespace balance_test {

namespace {

constexpr double R = 1e-3, g = 9.81;

/// Three grains of different radii in collision, one of them with a wall, and a fourth that touches an image
/// across the periodic side; all with friction
World collision(double h)
{
    WorldOptions o;
    o.low = {-0.005, -0.005, -0.005}, o.high = {0.005, 0.005, 0.005}, o.periodic = {true, false, false};
    o.gravity = {0, 0, -g}, o.h = h, o.scheme = Scheme::velocity_verlet;
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.3));
    Boundary floor;
    floor.r = {0, 0, -1e-3};
    world.add(floor);
    Particle p{.r = {0, 0, 1e-6}, .radius = R, .v = {0.1, 0.05, -0.3}};
    world.add(p);
    const auto add_beside = [&](double radius, Vec3 direction, const Vec3& v, const Vec3& omega) {
        direction = (1 / direction.norm()) * direction;
        p = {.r = p.r + 0.999 * (p.radius + radius) * direction, .radius = radius, .v = v, .omega = omega};
        if (p.r.x > 0.005) p.r.x -= 0.01;
        world.add(p);
    };
    add_beside(1.1 * R, {2.1, 0.2, 0.4}, {-0.4, 0, 0.1}, {0, 90, 0});
    add_beside(0.8 * R, {1.8, 0.2, 0.6}, {-0.5, 0.3, -0.4}, {0, 0, 0});
    add_beside(0.95 * R, {1.7, 0, 0.1}, {-0.6, 0.1, 0}, {50, 0, 20});
    return world;
}

/// Fields at a point
FieldValues at(const Vec3& x, const Kernel& kernel, const FieldInput& in)
{
    FieldSums sums({.low = {x.x - 1e-6, x.y - 1e-6, x.z - 1e-6},
                    .high = {x.x + 1e-6, x.y + 1e-6, x.z + 1e-6},
                    .period = {0.01, 0, 0},
                    .values = FieldGrid::Values::points},
                   kernel);
    sums.add(in);
    return sums.values(0);
}

/// The particles at t + dt with constant accelerations
FieldInput moved(FieldInput in, const std::vector<Vec3>& acceleration, double dt)
{
    for (std::size_t k = 0; k < in.particles.size(); ++k) {
        FieldParticle& p = in.particles[k];
        p.r += dt * p.v + 0.5 * dt * dt * acceleration[k];
        p.v += dt * acceleration[k];
    }
    return in;
}

/// Flux of momentum ρ v ⊗ v + σ through the planes normal to axis a
Vec3 flux(const FieldValues& f, std::size_t a)
{
    const double v[] = {f.velocity.x, f.velocity.y, f.velocity.z};
    const auto part = [&](std::size_t b) {
        return f.kinetic_stress[3 * a + b] + f.contact_stress[3 * a + b];
    };
    return v[a] * f.momentum + Vec3{part(0), part(1), part(2)};
}

/// Fourth-order difference quotient at 0 of a function of one variable
template <class F>
Vec3 derivative(double step, const F& f)
{
    return (1 / (12 * step)) * (8. * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step)));
}

Vec3 flux_divergence(const Vec3& x, const Kernel& kernel, const FieldInput& in)
{
    Vec3 divergence = {0, 0, 0};
    for (std::size_t a = 0; a < 3; ++a)
        divergence += derivative(2e-3 * kernel.width, [&](double by) {
            const Vec3 moved = {a == 0 ? by : 0, a == 1 ? by : 0, a == 2 ? by : 0};
            return flux(at(x + moved, kernel, in), a);
        });
    return divergence;
}

}  // namespace

TEST_CASE("the fields of colliding grains and a wall satisfy the balance of momentum", "[granular][fields]")
{
    World world = collision(2e-7);
    world.step(150);
    const std::vector<ContactRecord> contacts = world.contacts();
    REQUIRE(contacts.size() == 4);
    REQUIRE(contacts.back().boundary);
    const FieldInput in = field_input(world, contacts, 0);
    REQUIRE(in.particles.size() == 4);
    std::vector<Vec3> acceleration(4, Vec3{0, 0, -g});
    for (const ContactRecord& c : contacts) {
        acceleration[c.i] += (1 / in.particles[c.i].mass) * c.F;
        if (!c.boundary) acceleration[c.j] += (-1 / in.particles[c.j].mass) * c.F;
    }
    for (const Kernel& kernel : {Kernel{Kernel::Type::gaussian, R}, Kernel{Kernel::Type::lucy, 2.5 * R}}) {
        double largest = 0, residual = 0;
        for (const Vec3& x : {Vec3{0.1e-3, 0.2e-3, -0.4e-3}, Vec3{1e-3, 0, 0.3e-3}, Vec3{0, 0, -1e-3},
                              Vec3{2.5e-3, 0.7e-3, 0.4e-3}, Vec3{4.9e-3, 0.1e-3, 1e-3},
                              Vec3{-4.7e-3, 0.3e-3, 0.9e-3}, Vec3{0.3e-3, -0.1e-3, -1.4e-3}}) {
            const FieldValues here = at(x, kernel, in);
            const Vec3 rate = derivative(
                5e-6, [&](double dt) { return at(x, kernel, moved(in, acceleration, dt)).momentum; });
            const Vec3 divergence = flux_divergence(x, kernel, in);
            const Vec3 rest = rate + divergence - here.density * Vec3{0, 0, -g} - here.boundary_force;
            residual = std::max(residual, rest.norm());
            largest = std::max({largest, rate.norm(), divergence.norm(), here.boundary_force.norm()});
        }
        INFO(Kernel::names[static_cast<std::size_t>(kernel.type)] << ": " << residual / largest);
        CHECK(residual < 1e-7 * largest);
        CHECK(largest > 1e4);  // [N/m³]
    }
}

namespace {

/// Residual of the balance at a point over its largest term, at about 3e-5 s. The rate is that of the momenta
/// of three instants of a run.
Vec3 residual_of_run(double h)
{
    World world = collision(h);
    world.step(std::lround(3e-5 / h) - 1);
    const Kernel kernel{Kernel::Type::gaussian, R};
    const Vec3 x = {0.1e-3, 0.2e-3, -0.4e-3};
    const auto momentum = [&] { return at(x, kernel, field_input(world, world.contacts(), 0)).momentum; };
    const Vec3 before = momentum();
    world.step(1);
    const FieldInput in = field_input(world, world.contacts(), 0);
    world.step(1);
    const Vec3 rate = (1 / (2 * h)) * (momentum() - before), divergence = flux_divergence(x, kernel, in);
    const FieldValues here = at(x, kernel, in);
    const Vec3 rest = rate + divergence - here.density * Vec3{0, 0, -g} - here.boundary_force;
    return (1 / std::max(rate.norm(), divergence.norm())) * rest;
}

}  // namespace

TEST_CASE("the fields of a run satisfy the balance of momentum in the limit of small steps",
          "[granular][fields]")
{
    // With damping and friction the scheme is of first order. The error vanishes by extrapolation.
    const Vec3 coarse = residual_of_run(4e-8), fine = residual_of_run(2e-8);
    CHECK(fine.norm() < 2e-4);
    CHECK(std::log2(coarse.norm() / fine.norm()) == Approx(1).margin(0.05));
    CHECK((2. * fine - coarse).norm() < 1e-6);
}

TEST_CASE("the integrals of the fields are mass, momentum, energy and the loads", "[granular][fields]")
{
    World world = collision(2e-7);
    world.step(150);
    const std::vector<ContactRecord> contacts = world.contacts();
    const FieldInput in = field_input(world, contacts, 0);
    double mass = 0, square = 0;
    Vec3 momentum = {0, 0, 0};
    for (const FieldParticle& p : in.particles)
        mass += p.mass, momentum += p.mass * p.v, square += p.mass * p.v.dot(p.v);
    const World::Totals totals = world.totals();

    for (const Kernel& kernel : {Kernel{Kernel::Type::gaussian, R}, Kernel{Kernel::Type::lucy, 2.5 * R}}) {
        // a region that contains all kernels, one periodic axis, and one that contains the centres only
        const FieldGrid whole{.low = {-0.005, -0.005, -0.005},
                              .high = {0.005, 0.005, 0.006},
                              .cells = {9, 5, 11},
                              .period = {0.01, 0, 0}};
        FieldGrid tight = whole;
        tight.low = {-0.005, -0.001, -0.001}, tight.high = {0.005, 0.001, 0.0015}, tight.closed = true;
        for (const FieldGrid& grid : {whole, tight}) {
            FieldSums sums(grid, kernel);
            sums.add(in), sums.add(in);
            double M = 0, flux = 0;
            Vec3 P = {0, 0, 0}, load = {0, 0, 0};
            std::array<double, 9> stress = {};
            for (std::size_t k = 0; k < grid.count(); ++k) {
                const FieldValues f = sums.values(k);
                const double V = grid.volume();
                M += V * f.density, P += V * f.momentum, load += V * f.boundary_force;
                for (std::size_t a = 0; a < 9; ++a) stress[a] += V * f.contact_stress[a];
                for (std::size_t a = 0; a < 9; a += 4) flux += V * f.kinetic_stress[a];
                flux += V * f.density * f.velocity.dot(f.velocity);
            }
            CHECK(M == Approx(mass).epsilon(1e-14));
            CHECK((P - momentum).norm() < 1e-14 * momentum.norm());
            CHECK(flux == Approx(square).epsilon(1e-14));
            CHECK((load + totals.on_boundary[0].F).norm() < 1e-13 * load.norm());
            for (std::size_t a = 0; a < 9; ++a)
                CHECK(stress[a] == Approx(totals.stress[a] * world.volume())
                                       .margin(1e-7 * std::abs(totals.stress[8]) * world.volume()));
        }
    }
}

}  // namespace balance_test
