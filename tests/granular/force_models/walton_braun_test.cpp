// SPDX-License-Identifier: GPL-3.0-or-later
// The normal law walton-braun: path of the force, restitution, and its internal variable in rebuilds,
// checkpoints and energy balances.
#include "granular/case/case_file.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::ContactPoint;
using granular::DoubleWorld;
using granular::History;
using granular::WaltonBraun;

namespace walton_braun_test {

namespace {

constexpr double R = 1e-3, m = 1e-5, k_1 = 1e3;

PairLaw plastic(double k_2, double S = 0)
{
    PairLaw law;
    law.normal = WaltonBraun{.k_1 = k_1, .k_2 = float(k_2), .S = float(S)};
    return law;
}

WorldOptions space(double h)
{
    WorldOptions o;
    o.low = {-20 * R, -20 * R, -20 * R}, o.high = {20 * R, 20 * R, 20 * R};
    o.gravity = {0, 0, 0}, o.h = h;
    return o;
}

/// Two spheres with the closing speed v, which touch at once; `drift` is their common velocity
std::vector<Particle> head_on(double v, const Vec3& drift = {0, 0, 0})
{
    return {{.r = {0, 0, 0}, .radius = R, .v = drift + Vec3{0, 0, v / 2}, .mass = m},
            {.r = {0, 0, 2 * R}, .radius = R, .v = drift - Vec3{0, 0, v / 2}, .mass = m}};
}
double separation_rate(const std::vector<Particle>& all) { return all[1].v.z - all[0].v.z; }

/// Duration of the contact [s]: quarters of the periods with k_1 and k_2 ≥ k_1, m* = m/2
const double duration = M_PI * std::sqrt(m / 2 / k_1);

World pair(const PairLaw& law, double h, double v, const Vec3& drift = {0, 0, 0}, double skin = 0.1)
{
    WorldOptions o = space(h);
    o.skin = skin;
    World world(o, {glass()});
    world.set_law(0, 0, law);
    for (const Particle& p : head_on(v, drift)) world.add(p);
    return world;
}

}  // namespace

TEST_CASE("walton-braun loads along k_1 and unloads and reloads along k_2", "[granular][laws]")
{
    for (const double S : {0., 2000.}) {
        const PairLaw law = plastic(4 * k_1, S);
        History<double> history{};
        const auto force = [&](double delta) {
            ContactPoint<double> contact{};
            contact.delta = delta, contact.R_i = contact.R_j = R, contact.R_eff = R / 2,
            contact.m_eff = m / 2;
            contact.n = {0, 0, 1}, contact.v_t = contact.omega = {0, 0, 0}, contact.h = 1e-6;
            return evaluate(law, contact, history, false).F.z;
        };
        const double first = 2e-5, second = 3e-5;
        const auto line = [&](double largest, double delta) {
            const double K = 4 * k_1 + S * k_1 * largest, free = largest * (1 - k_1 / K);
            return std::max(0., K * (delta - free));
        };
        for (const double d : {0.25, 0.5, 1.})
            CHECK(force(d * first) == Approx(k_1 * d * first).epsilon(1e-12));
        for (const double d : {0.95, 0.9, 0.8, 0.5, 0.1, 0.5, 0.85, 0.99, 1.})  // with a part without force
            CHECK(force(d * first) == Approx(line(first, d * first)).margin(1e-12 * k_1 * first));
        CHECK(line(first, 0.5 * first) == 0);
        for (const double d : {1.1, 1.3, 1.5})
            CHECK(force(d * first) == Approx(k_1 * d * first).epsilon(1e-12));
        for (const double d : {0.95, 0.85, 0.7, 0.9})
            CHECK(force(d * second) == Approx(line(second, d * second)).margin(1e-12 * k_1 * second));
        CHECK(history.largest_overlap == Approx(second).epsilon(1e-15));
    }
}

TEST_CASE("the restitution of walton-braun is sqrt(k_1/k_2) for all velocities", "[granular][laws]")
{
    const double h = duration / 20000;
    for (const double e : {0.2, 0.5, 0.9, 1.})
        for (const double v : {0.01, 0.1, 1.}) {
            DoubleWorld world(space(h), plastic(k_1 / (e * e)));
            world.particle = head_on(v);
            world.step(22000);
            CAPTURE(e, v);
            CHECK(separation_rate(world.particle) == Approx(e * v).epsilon(1e-4));
        }
    // first order in the step
    const auto error = [&](double step) {
        DoubleWorld world(space(step), plastic(4 * k_1));
        world.particle = head_on(0.1);
        world.step(std::lround(1.2 * duration / step));
        return std::abs(separation_rate(world.particle) / 0.1 - 0.5);
    };
    CHECK(error(duration / 2000) < 2e-3);
    CHECK(error(duration / 200) < 2e-2);
}

TEST_CASE("the restitution of walton-braun with S decreases with the velocity", "[granular][laws]")
{
    const double S = 3000;
    for (const double v : {0.02, 0.2, 0.6}) {
        const double e = std::sqrt(k_1 / (k_1 + S * v * std::sqrt(m / 2 * k_1)));
        DoubleWorld world(space(duration / 20000), plastic(k_1, S));
        world.particle = head_on(v);
        world.step(22000);
        CAPTURE(v, e);
        CHECK(separation_rate(world.particle) == Approx(e * v).epsilon(1e-4));
    }
}

TEST_CASE("the largest overlap survives rebuilds of the neighbour list in either order of the particles",
          "[granular][laws]")
{
    // The pair flies through the cells, so that it is rebuilt often and changes its order.
    const double h = duration / 2000, v = 0.1;
    const PairLaw law = plastic(4 * k_1);
    const double alone = [&] {
        World world = pair(law, h, v);
        world.step(2400);
        CHECK(world.rebuilds() == 1);
        return separation_rate(world.particles());
    }();
    CHECK(alone == Approx(0.5 * v).epsilon(2e-3));
    for (const Vec3& drift : {Vec3{20, 0, 0}, Vec3{0, 20, 20}, Vec3{0, 0, -20}, Vec3{-20, 20, 0}}) {
        World world = pair(law, h, v, drift, 0.02);
        world.step(2400);
        CHECK(world.rebuilds() > 100);
        CHECK(separation_rate(world.particles()) == Approx(alone).epsilon(1e-3));
    }
}

TEST_CASE("a checkpoint contains the largest overlap", "[granular][laws][checkpoint]")
{
    const double h = duration / 1000;
    PairLaw law = plastic(4 * k_1);
    law.tangential = granular::Mindlin{.spring = {.k_t = 500}, .cap = {0.5f, 0.5f}};
    law.rolling = granular::Epsd{.mu_r = 0.1f};
    for (const long at : {100, 700}) {  // while the contact is loaded and unloaded
        World world = pair(law, h, 0.1, {0.1, 0, 0}), restored = pair(law, h, 0.1);
        world.step(at);
        const std::string bytes = world.to_bytes("");
        restored.from_bytes(bytes, "", "file", [](io::Archive&) {});
        CHECK((restored.to_bytes("") == bytes));
        REQUIRE(world.contacts().size() == 1);
        CHECK(world.contacts()[0].F == restored.contacts()[0].F);
        world.step(1200 - at), restored.step(1200 - at);
        CHECK(separation_rate(world.particles()) == Approx(0.05).epsilon(1e-2));
        for (std::size_t k = 0; k < 2; ++k) {
            const Particle a = world.particles()[k], b = restored.particles()[k];
            CHECK((a.r == b.r && a.v == b.v && a.omega == b.omega));
        }
    }
}

TEST_CASE("the energy balance of walton-braun has its plastic work as dissipation", "[granular][laws][watch]")
{
    const double e = 0.5, v = 0.1, T = 0.25 * m * v * v;
    World world = pair(plastic(k_1 / (e * e)), duration / 2000, v);
    world.set_watch(true, 1);
    double last = 0;
    for (int k = 0; k < 2400; ++k) {
        world.step();
        const double now = world.watch().dissipated;
        REQUIRE(now >= last - 1e-5 * T);  // the kink of the force at the end of the contact
        last = std::max(last, now);
    }
    CHECK(world.watch().is_driven == 0);
    CHECK(last == Approx((1 - e * e) * T).epsilon(2e-3));
    CHECK(world.watch().largest_gain < 1e-5 * T);
}

TEST_CASE("the case gives k_2 or the restitution of walton-braun", "[granular][laws][case]")
{
    const auto rebound = [](const std::string& keys) {
        auto read = granular::read_case(R"({"hilda_case": 1, "step": 1e-7, "end": 1,
            "domain": {"low": [-0.01, -0.01, -0.01], "high": [0.01, 0.01, 0.01]}, "gravity": [0, 0, 0],
            "materials": [{"name": "a", "density": 2500, "E": 1e7, "nu": 0.3}],
            "laws": [{)" + keys + R"(}],
            "particles": [{"r": [0, 0, 0], "radius": 0.001, "material": "a", "v": [0, 0, 0.05]},
                          {"r": [0, 0, 0.002], "radius": 0.001, "material": "a", "v": [0, 0, -0.05]}]})",
                                        "case");
        read.world->step(4000);
        return separation_rate(read.world->particles()) / 0.1;
    };
    CHECK(rebound(R"("normal": {"law": "walton-braun", "k_1": 1000, "k_2": 4000})") ==
          Approx(0.5).epsilon(5e-3));
    CHECK(rebound(R"("restitution": 0.25, "normal": {"law": "walton-braun", "k_1": 1000})") ==
          Approx(0.25).epsilon(5e-3));
    CHECK_THROWS_WITH(rebound(R"("normal": {"law": "walton-braun", "k_1": 1000, "k_2": 500})"),
                      Catch::Contains("k_2 must not be less than k_1, 1000, got 500"));
    CHECK_THROWS_WITH(rebound(R"("normal": {"law": "walton-braun", "k_1": 1000})"),
                      Catch::Contains("restitution"));
}

}  // namespace walton_braun_test
