// SPDX-License-Identifier: GPL-3.0-or-later
// The watch over granular runs: balances of energy and momentum, overlaps, displacements, and no influence on
// the results.
#include "granular/case/case_file.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Scheme;
using granular::soft_sphere;
using granular::WatchRecord;

namespace watch_test {

namespace {

/// Soft spheres of 0.5 m radius in a box from -3 m to 3 m
WorldOptions space(double h, Scheme scheme = Scheme::symplectic_euler, Vec3 gravity = {0, 0, 0})
{
    WorldOptions o;
    o.low = {-3, -3, -3}, o.high = {3, 3, 3};
    o.gravity = gravity, o.h = h, o.scheme = scheme;
    return o;
}

/// Two spheres that collide with 1 m/s each; the first sample is before the collision, the last one after it.
/// Their energy is 1 J.
World collision(double h, Scheme scheme, const PairLaw& law, double offset = 0)
{
    World world(space(h, scheme), {soft()});
    world.set_law(0, 0, law);
    world.set_watch(true, 1);
    for (const double side : {-1., 1.}) {
        Particle p = soft_sphere();
        p.r = {side * 0.502 - (side < 0 ? offset : 0), 0, 0}, p.v = {-side, 0, 0};
        world.add(p);
    }
    world.step(std::lround(0.06 / h));
    REQUIRE(world.contacts().empty());
    return world;
}

PairLaw spring(float k)
{
    PairLaw law;
    law.normal = granular::Hooke{.k_n = k};
    return law;
}

double energy(const WatchRecord& w) { return w.kinetic + w.potential + w.normal + w.tangential; }

/// A bed of 240 beads in a box, with friction, rolling and spin laws
std::unique_ptr<World> bed(Scheme scheme, Vec3 gravity = {0, 0, -9.81}, bool periodic = false)
{
    constexpr double R = 1e-3;
    WorldOptions o;
    o.low = {0, 0, -2 * R}, o.high = {14 * R, 14 * R, 60 * R};
    o.periodic = {periodic, periodic, false};
    o.gravity = gravity, o.h = 4e-6, o.scheme = scheme;
    auto world = std::make_unique<World>(o, std::vector<Material>{glass()});
    PairLaw law = hertz_mindlin(glass(), 0.6, 0.4);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    law.spin = granular::TorsionalSpring{.mu = 0.4f};
    world->set_law(0, 0, law);
    if (periodic)
        world->add(Boundary{});
    else
        for (const Boundary& b : granular::open_box({0, 0, 0}, {14 * R, 14 * R, 0})) world->add(b);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int k = 0; k < 240; ++k) {
        Particle p;
        p.radius = R * (0.9 + 0.09 * in(random));
        const int column = k % 6, row = k / 6 % 6, layer = k / 36;
        p.r = {R * (1.2 + 2.1 * column + 0.05 * in(random)), R * (1.2 + 2.1 * row + 0.05 * in(random)),
               R * (1.5 + 2.2 * layer)};
        p.v = {0.1 * in(random), 0.1 * in(random), 0.1 * in(random)};
        world->add(p);
    }
    return world;
}

}  // namespace

TEST_CASE("the kinetic energy of a sphere has the part of its rotation", "[granular][watch]")
{
    World world(space(1e-4), {soft()});
    world.set_law(0, 0, spring(1e5f));
    Particle p = soft_sphere();
    p.v = {3, 0, 0}, p.omega = {0, 4, 0};
    world.add(p);
    world.step(1);
    const Particle after = world.particles()[0];
    CHECK(world.kinetic_energy() ==
          Approx(0.5 * after.mass * 9 + 0.5 * (0.4 * after.mass * 0.25) * 16).epsilon(1e-6));
}

TEST_CASE("the energy of an elastic collision is balanced to second order in the step", "[granular][watch]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    INFO(granular::scheme_names[static_cast<int>(scheme)]);
    const bool hertz = GENERATE(false, true);
    const PairLaw law = hertz ? hertz_mindlin(soft(), 1) : spring(2e4f);
    const auto error = [&](double h) {
        double largest = 0;  // over the instants of the contact within a step
        for (int k = 0; k < 8; ++k) {
            const World world = collision(h, scheme, law, 2 * h * k / 8);
            const WatchRecord& w = world.watch();
            CHECK(w.is_driven == 0);
            CHECK(w.largest_kinetic == Approx(1).epsilon(5e-3));
            CHECK(w.work == 0);
            largest = std::max({largest, std::abs(w.dissipated), w.largest_gain});
        }
        return largest;
    };
    const double coarse = error(4e-4), fine = error(1e-4);
    INFO(coarse << ", " << fine);
    CHECK(coarse < 5e-3);
    CHECK(std::log(coarse / fine) / std::log(4) > 1.7);
}

TEST_CASE("the watch sees the largest overlap and displacement of all steps", "[granular][watch]")
{
    const double h = 1e-5;
    const World world = collision(h, Scheme::symplectic_euler, spring(2e4f));
    // m* v²/2 = k δ²/2 with the relative velocity 2 m/s
    CHECK(world.watch().largest_overlap == Approx(2 * std::sqrt(0.5 / 2e4) / 0.5).epsilon(1e-3));
    CHECK(world.watch().largest_displacement == Approx(h * 1 / 0.5).epsilon(1e-5));
    CHECK(world.watch().warnings == 0);
    CHECK(world.watch().samples == world.steps());
}

TEST_CASE("the dissipated energy of a damped collision is 1 - e² of the energy", "[granular][watch]")
{
    const double e = GENERATE(0.3, 0.5, 0.9);
    const World world = collision(1e-5, Scheme::symplectic_euler, hertz_mindlin(soft(), e));
    CHECK(world.watch().dissipated == Approx(1 - e * e).epsilon(2e-3));
    CHECK(world.watch().largest_gain < 1e-6);
    CHECK(world.watch().largest_momentum_residual < 1e-6 * world.watch().largest_momentum);
}

TEST_CASE("energy and momentum of a bed under gravity are balanced (long)", "[granular][watch]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet, Scheme::chung);
    INFO(granular::scheme_names[static_cast<int>(scheme)]);
    const auto world = bed(scheme);
    world->step(1);
    const double start = energy(world->watch());
    world->step(15000);
    const WatchRecord& w = world->watch();
    CHECK(w.is_driven == 0);
    CHECK(w.work == 0);
    CHECK(w.dissipated == Approx(start - energy(w)).epsilon(1e-6));
    CHECK(w.dissipated > 0.5 * w.largest_kinetic);
    CHECK(w.largest_gain < 1e-3 * w.largest_kinetic);
    CHECK(w.largest_momentum_residual < 1e-5 * w.largest_momentum);
    CHECK(w.normal > 0);
    CHECK(w.tangential > 0);
    // the floor has taken the weight
    CHECK(w.impulse.norm() < 0.1 * w.mass * 9.81 * world->t());
}

TEST_CASE("gravity along a periodic axis does work (long)", "[granular][watch]")
{
    const auto world = bed(Scheme::symplectic_euler, {4, 0, -9}, true);
    world->step(1);
    const double start = energy(world->watch());
    // the last step is a sample; the work is that until the next step
    world->step(150 * granular::watch_limit::interval);
    const WatchRecord& w = world->watch();
    CHECK(w.work > 0.1 * w.largest_kinetic);
    CHECK(w.dissipated == Approx(start + w.work - energy(w)).epsilon(1e-3).margin(1e-3 * w.largest_kinetic));
    CHECK(w.largest_gain < 1e-3 * w.largest_kinetic);
    CHECK(w.largest_momentum_residual < 1e-5 * w.largest_momentum);
}

TEST_CASE("the work of a moving boundary is the gain of energy", "[granular][watch]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    INFO(granular::scheme_names[static_cast<int>(scheme)]);
    World world(space(2e-5, scheme), {soft()});
    world.set_law(0, 0, hertz_mindlin(soft(), 1));
    Boundary wall;
    wall.axis = {1, 0, 0}, wall.r = {-1, 0, 0}, wall.v = {0.8, 0, 0};
    world.add(wall);
    Particle p = soft_sphere();
    p.r = {-0.45, 0, 0}, p.v = {-0.3, 0, 0};
    world.add(p);
    world.step(6000);
    REQUIRE(world.contacts().empty());
    const double v = world.particles()[0].v.x;
    CHECK(v == Approx(2 * 0.8 + 0.3).epsilon(1e-4));
    const WatchRecord& w = world.watch();
    CHECK(w.is_driven == 1);
    CHECK(w.work == Approx(0.5 * (v * v - 0.3 * 0.3)).epsilon(1e-3));
    CHECK(std::abs(w.dissipated) < 1e-3 * w.work);
    CHECK(w.impulse.x == Approx(v + 0.3).epsilon(1e-5));
}

TEST_CASE("a rotating boundary and a rotating fixed sphere do the work of their friction",
          "[granular][watch]")
{
    // A sphere at rest between gravity and a support is driven by friction until it rolls.
    const bool fixed = GENERATE(false, true);
    World world(space(1e-5, Scheme::symplectic_euler, {0, 0, -9.81}), {soft()});
    PairLaw law;
    law.normal = granular::Hooke{.k_n = 2e4f, .gamma_n = 50};
    law.tangential = granular::Mindlin{.spring = {.k_t = 1e4f}, .cap = {0.2f, 0.2f}};
    world.set_law(0, 0, law);
    Particle p = soft_sphere();
    if (fixed) {
        p.r = {0, 0, -0.5}, p.omega = {0, 0.2, 0}, p.fixed = true;
        world.add(p);
    } else {
        Boundary drum;
        drum.shape = Boundary::Shape::cylinder, drum.axis = {0, 1, 0}, drum.r = {0, 0, -0.5},
        drum.radius = 0.5;
        drum.omega = {0, 0.2, 0};
        world.add(drum);
    }
    p = soft_sphere();
    p.r = {0, 0, 0.5};
    world.add(p);
    world.step(30000);
    const WatchRecord& w = world.watch();
    CHECK(w.is_driven == 1);
    const Particle moving = world.particles().back();
    REQUIRE(moving.omega.norm() > 0.05);
    CHECK(w.work > 0.2 * w.kinetic);
    CHECK(w.dissipated > 0);
    CHECK(w.largest_gain < 1e-3 * w.largest_kinetic);
    CHECK(w.largest_momentum_residual < 1e-5 * w.largest_momentum);
}

TEST_CASE("the work of a rotating fixed sphere includes its torques, whichever of the two has the smaller id",
          "[granular][watch]")
{
    const int fixed = GENERATE(0, 1);
    const double h = 1e-5;
    World world(space(h, Scheme::symplectic_euler, {0, 0, -9.81}), {soft()});
    PairLaw law;
    law.normal = granular::Hooke{.k_n = 2e4f, .gamma_n = 50};
    law.tangential = granular::Mindlin{.spring = {.k_t = 1e4f}, .cap = {0.2f, 0.2f}};
    law.rolling = granular::ConstantTorque{.mu_r = 0.05f, .slow = 1e-3f};
    world.set_law(0, 0, law);
    Particle turning = soft_sphere(), moving = soft_sphere();
    turning.r = {0, 0, -0.5}, turning.omega = {0, 0.2, 0.1}, turning.fixed = true;
    moving.r = {0, 0, 0.5};
    world.add(fixed == 0 ? turning : moving);
    world.add(fixed == 0 ? moving : turning);
    double work = 0, of_torque = 0;
    for (int k = 0; k < 8000; ++k) {
        world.step(1);
        for (const granular::ContactRecord& c : world.contacts()) {
            const double sign = static_cast<int>(c.i) == fixed ? 1 : -1;  // F and T act on i
            const Vec3 T = sign * c.T, on_fixed = T + sign * (c.C - turning.r).cross(c.F);
            work -= h * on_fixed.dot(turning.omega), of_torque -= h * T.dot(turning.omega);
        }
    }
    const WatchRecord& w = world.watch();
    CAPTURE(fixed);
    CHECK(std::abs(of_torque) > 0.02 * std::abs(work));
    CHECK(w.work == Approx(work).epsilon(2e-3));
    CHECK(w.largest_momentum_residual < 1e-5 * w.largest_momentum);
    CHECK(w.largest_gain < 1e-3 * w.largest_kinetic);
}

TEST_CASE("a step far too large ends with energy_created or overlap_too_large", "[granular][watch]")
{
    const auto statuses = [](double h) {
        WorldOptions o = space(h, Scheme::symplectic_euler, {0, 0, -9.81});
        o.high.z = 900;
        World world(o, {soft()});
        world.set_law(0, 0, spring(2e4f));
        world.add(Boundary{});
        Particle p = soft_sphere();
        p.r = {0, 0, 0.6};
        world.add(p);
        try {
            world.step(std::lround(20 / h));
        } catch (const io::NumericalFailure& e) {
            return e.status;
        }
        return std::string("ok");
    };
    CHECK(statuses(1e-4) == "ok");
    const std::string coarse = statuses(1.9e-2);  // the stability limit is 2/ω = 0.0141 s
    INFO(coarse);
    CHECK((coarse == "energy_created" || coarse == "overlap_too_large"));
}

TEST_CASE("energy from a law that is not passive ends the run with energy_created", "[granular][watch]")
{
    // A negative damping constant adds energy in each contact; a case file cannot state it.
    PairLaw law;
    law.normal = granular::Hooke{.k_n = 2e4f, .gamma_n = -8};
    World world(space(1e-4, Scheme::symplectic_euler, {0, 0, -9.81}), {soft()});
    world.set_law(0, 0, law);
    world.add(Boundary{});
    Particle p = soft_sphere();
    p.r = {0, 0, 0.7};
    world.add(p);
    CHECK_THROWS_WITH(world.step(20000), Catch::Contains("have gained") && Catch::Contains("a smaller step"));
    CHECK(world.watch().largest_gain > 0.01 * world.watch().largest_kinetic);

    World without(space(1e-4, Scheme::symplectic_euler, {0, 0, -9.81}), {soft()});
    without.set_law(0, 0, law);
    without.add(Boundary{});
    without.set_watch(false);
    without.add(p);
    CHECK_NOTHROW(without.step(20000));
    CHECK(without.watch().samples == 0);
}

TEST_CASE("an overlap above half of the smaller radius ends the run and names the pair", "[granular][watch]")
{
    World world(space(1e-4), {soft()});
    world.set_law(0, 0, spring(100));
    for (const double side : {-1., 1.}) {
        Particle p = soft_sphere();
        p.r = {side * 0.502, 0, 0}, p.v = {-side * 4, 0, 0};
        world.add(p);
    }
    CHECK_THROWS_WITH(world.step(10000), Catch::Contains("particle 0 and particle 1 overlap by 0.5"));
    CHECK(world.watch().largest_overlap > 0.5);
    CHECK((world.watch().warnings & WatchRecord::deep) != 0);
    CHECK_FALSE(watch_warning(world.watch(), WatchRecord::deep).empty());
}

TEST_CASE("a displacement above a tenth of the radius in a step is a warning", "[granular][watch]")
{
    World world(space(1e-3), {soft()});
    world.set_law(0, 0, spring(100));
    Particle p = soft_sphere();
    p.r = {-2, 0, 0}, p.v = {60, 0, 0};
    world.add(p);
    world.step(3);
    CHECK(world.watch().largest_displacement == Approx(0.12));
    CHECK(world.watch().warnings == WatchRecord::fast);
}

TEST_CASE("particles and velocities from outside start a new balance", "[granular][watch]")
{
    World world(space(1e-4, Scheme::symplectic_euler, {0, 0, -9.81}), {soft()});
    world.set_law(0, 0, hertz_mindlin(soft(), 0.5));
    world.add(Boundary{});
    Particle p = soft_sphere();
    p.r = {0, 0, 0.5};
    world.add(p);
    world.step(5000);
    const double before = world.watch().dissipated;
    world.set_velocity(0, {0, 0, 3}, {0, 0, 0});
    p.r = {2, 0, 2};
    world.add(p);
    world.step(1);
    CHECK(world.watch().dissipated == Approx(before).margin(1e-9));
    world.step(5000);
    CHECK(world.watch().is_driven == 0);
    CHECK(world.watch().dissipated > before);
    CHECK(world.watch().largest_gain < 1e-3 * world.watch().largest_kinetic);
    CHECK(world.watch().largest_momentum_residual < 1e-5 * world.watch().largest_momentum);
}

TEST_CASE("the watch does not change the results and survives a checkpoint (long)", "[granular][watch]")
{
    const Scheme scheme = GENERATE(Scheme::symplectic_euler, Scheme::velocity_verlet);
    const auto without = bed(scheme), with = bed(scheme), resumed = bed(scheme);
    without->set_watch(false);
    without->step(4000), with->step(4000);
    const auto a = without->particles(), b = with->particles();
    REQUIRE(a.size() == b.size());
    bool same = true;
    for (std::size_t k = 0; k < a.size(); ++k)
        same = same && a[k].r == b[k].r && a[k].v == b[k].v && a[k].omega == b[k].omega;
    CHECK(same);
    resumed->from_bytes(with->to_bytes("run"), "run", "checkpoint");
    with->step(3000), resumed->step(3000);
    const bool same_bytes = with->to_bytes("run") == resumed->to_bytes("run");  // the record is part of them
    CHECK(same_bytes);
    CHECK(with->watch().samples == 7000 / granular::watch_limit::interval + 1);
}

}  // namespace watch_test
