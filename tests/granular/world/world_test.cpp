// SPDX-License-Identifier: GPL-3.0-or-later
// Many particles: contacts, conservation laws, independence of threads and of order.
#include "granular/world/output.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <omp.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::ContactRecord;

namespace world_test {

namespace {

constexpr double R = 1e-3;

struct RandomNumbers {
    std::mt19937 engine;
    double number(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
};

WorldOptions box(double width, double height)
{
    WorldOptions o;
    o.low = {-2 * R, -2 * R, -2 * R}, o.high = {width + 2 * R, width + 2 * R, height};
    o.h = 5e-6;
    return o;
}

void add_walls(World& world, double width)
{
    for (const Boundary& b : granular::open_box({0, 0, 0}, {width, width, 0})) world.add(b);
}

/// A loose heap of n³ particles with radii between (1 - spread) R and R
std::vector<Particle> heap(int n, double spread, RandomNumbers& random)
{
    std::vector<Particle> all;
    for (int k = 0; k < n * n * n; ++k) {
        Particle p;
        p.radius = R * (1 - random.number(0, spread));
        const int column = k % n, row = k / n % n, layer = k / (n * n);
        p.r = 2.1 * R * Vec3{column + 0.6, row + 0.6, layer + 0.6} + random.vector(0.03 * R);
        p.v = random.vector(0.2), p.omega = random.vector(50);
        all.push_back(p);
    }
    return all;
}

double width_of(int n) { return 2.1 * R * (n + 0.2); }

}  // namespace

TEST_CASE("the neighbour list finds the contacts of all pairs (long)", "[granular][neighbours]")
{
    const bool periodic = GENERATE(false, true);
    const double spread = GENERATE(0., 0.6);
    RandomNumbers random{std::mt19937(7)};
    constexpr int n = 7;
    const double width = width_of(n);
    WorldOptions o = box(width, width + 4 * R);
    if (periodic)
        o.low = {0, 0, -2 * R}, o.high = {width, width, width + 4 * R}, o.periodic = {true, true, false};
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.7, 0.4));
    if (periodic)
        world.add(Boundary{});
    else
        add_walls(world, width);
    const auto heaped = heap(n, spread, random);
    for (const Particle& p : heaped) world.add(p);
    int seen = 0;
    for (int k = 0; k < 10; ++k) {
        world.step(1200);
        const auto before = world.particles();
        std::set<std::pair<unsigned, unsigned>> all, found;
        for (unsigned i = 0; i < before.size(); ++i)
            for (unsigned j = i + 1; j < before.size(); ++j) {
                Vec3 d = before[i].r - before[j].r;
                if (periodic) d.x -= width * std::round(d.x / width), d.y -= width * std::round(d.y / width);
                const double overlap = before[i].radius + before[j].radius - d.norm();
                if (overlap > 1e-10) all.insert({i, j});
            }
        for (const ContactRecord& c : world.contacts())
            if (!c.boundary) found.insert({c.i, c.j});
        for (const auto& pair : all) CHECK(found.count(pair) == 1);
        seen += static_cast<int>(all.size());
        CHECK(found.size() <= all.size() + 2);  // overlaps below 1e-10 m
    }
    CHECK(seen > 200);
    CHECK(world.rebuilds() > 5);
    CHECK(world.rebuilds() < 2000);
}

TEST_CASE("particles at rest are hit by moving and rotating boundaries", "[granular][neighbours]")
{
    // only the motion of the boundaries triggers rebuilds of the neighbour list
    const bool turns = GENERATE(false, true);
    WorldOptions o;
    o.low = {-50 * R, -50 * R, -50 * R}, o.high = {50 * R, 60 * R, 50 * R};
    o.h = 5e-6, o.gravity = {0, 0, 0};
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.4));
    Boundary plate;
    plate.axis = {1, 0, 0}, plate.r = {turns ? 0 : -4 * R, 0, 0};
    if (turns)
        plate.omega = {0, 0, -10};
    else
        plate.v = {0.3, 0, 0};
    world.add(plate);
    for (int k = 0; k < 20; ++k) {
        const int layer = k % 2, row = k / 2;
        world.add(Particle{.r = {(1.3 + 0.3 * k) * R, (1 + 2.2 * row) * R, layer * 3 * R}, .radius = R});
    }
    std::set<unsigned> touched;
    for (int k = 0; k < 3000; ++k) {
        world.step(3);
        const auto grains = world.particles();
        std::set<unsigned> found;
        for (const ContactRecord& c : world.contacts())
            if (c.boundary) found.insert(c.i);
        for (unsigned i = 0; i < grains.size(); ++i) {
            if (R - nearest(world.boundary(0), grains[i].r).distance > 1e-10) touched.insert(i);
            if (touched.count(i) == 0) REQUIRE(grains[i].v.norm() == 0);
        }
        for (const unsigned i : touched)
            if (grains[i].v.norm() == 0) CHECK(found.count(i) == 1);  // first contact
    }
    CHECK(touched.size() > 3);
}

TEST_CASE("totals are the sums over the contacts, for any number of threads", "[granular][deterministic]")
{
    const int threads = omp_get_max_threads();
    RandomNumbers random{std::mt19937(5)};
    constexpr int n = 12;
    WorldOptions o = box(width_of(n), width_of(n) + 4 * R);
    o.gravity = {1, 2, -9.81};
    World world(o, {glass()});
    PairLaw law = hertz_mindlin(glass(), 0.5, 0.4);
    law.rolling = granular::Epsd{.mu_r = 0.1f, .eta_r = 0.3f};
    world.set_law(0, 0, law);
    add_walls(world, width_of(n));
    // each particle overlaps its neighbours by a hundredth of a diameter
    const auto loose = heap(n, 0, random);
    for (int k = 0; k < n * n * n; ++k) {
        Particle p = loose[static_cast<std::size_t>(k)];
        p.r = 1.98 * R * Vec3{k % n + 0.5, k / n % n + 0.5, k / (n * n) % n + 0.5};
        world.add(p);
    }
    world.step(40);
    omp_set_num_threads(1);
    const World::Totals one = world.totals();
    omp_set_num_threads(3);
    const World::Totals three = world.totals();
    omp_set_num_threads(threads);
    const auto contacts = world.contacts();
    CHECK(
        std::is_sorted(contacts.begin(), contacts.end(), [](const ContactRecord& a, const ContactRecord& b) {
            return std::tuple(a.boundary, a.i, a.j) < std::tuple(b.boundary, b.i, b.j);
        }));
    REQUIRE(contacts.size() > 2500);
    CHECK(one.contacts == contacts.size());
    CHECK(one.stress == three.stress);
    const auto sigma = stress(world, contacts, world.volume());
    for (int k = 0; k < 9; ++k) CHECK(one.stress[k] == Approx(sigma[k]).margin(1e-7 * sigma[8]));
    for (int b = 0; b < 5; ++b) {
        const granular::Wrench on = world.wrench(contacts, b);
        CHECK((one.on_boundary[b].F - on.F).norm() <= 1e-12 * on.F.norm());
        CHECK((one.on_boundary[b].T - on.T).norm() <= 1e-12 * on.T.norm());
        CHECK(one.on_boundary[b].F == three.on_boundary[b].F);
    }
}

TEST_CASE("results are bitwise identical for any number of threads", "[granular][deterministic]")
{
    const int threads = omp_get_max_threads();
    std::vector<Particle> first;
    for (const int t : {1, 2, 3, 4, 8}) {
        omp_set_num_threads(t);
        RandomNumbers random{std::mt19937(3)};
        constexpr int n = 16;
        World world(box(width_of(n), width_of(n) + 4 * R), {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.7, 0.4));
        add_walls(world, width_of(n));
        for (const Particle& p : heap(n, 0.3, random)) world.add(p);
        world.step(300);
        const auto now = world.particles();
        if (first.empty()) first = now;
        bool same = true;
        for (std::size_t k = 0; k < now.size(); ++k)
            same = same && now[k].r == first[k].r && now[k].v == first[k].v && now[k].omega == first[k].omega;
        INFO(t << " threads");
        CHECK(same);
    }
    omp_set_num_threads(threads);
}

TEST_CASE("free particles conserve momentum", "[granular][invariant]")
{
    RandomNumbers random{std::mt19937(5)};
    constexpr int n = 6;
    WorldOptions o = box(width_of(n), width_of(n));
    const double far = 0.1;
    o.low = {-far, -far, -far}, o.high = {far, far, far}, o.gravity = {0, 0, 0};
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.9, 0.3));
    for (Particle p : heap(n, 0.2, random)) {
        p.r = 0.97 * p.r, p.v = p.v - 100 * p.r;  // towards each other
        world.add(p);
    }
    world.step();
    Vec3 before = world.momentum();
    double scale = 0;
    for (const Particle& p : world.particles()) scale += p.mass * p.v.norm();
    std::size_t contacts = 0;
    for (int k = 0; k < 200; ++k) {
        world.step(10);
        contacts += world.contacts().size();
        const Vec3 now = world.momentum();
        CHECK((now - before).norm() < 10 * 6e-8 * scale / std::sqrt(static_cast<double>(world.count())));
        before = now;
    }
    CHECK(contacts > 1000);
}

TEST_CASE("friction never exceeds its bound", "[granular][invariant]")
{
    RandomNumbers random{std::mt19937(9)};
    constexpr int n = 6;
    World world(box(width_of(n), width_of(n) + 4 * R), {glass()});
    const double mu = 0.35;
    world.set_law(0, 0, hertz_mindlin(glass(), 0.6, mu));
    add_walls(world, width_of(n));
    for (const Particle& p : heap(n, 0.2, random)) world.add(p);
    int slid = 0;
    world.step(8000);
    for (int k = 0; k < 500; ++k) {
        world.step();
        for (const ContactRecord& c : world.contacts()) {
            const double F_n = c.F.dot(c.n), F_t = (c.F - F_n * c.n).norm();
            REQUIRE(F_t <= mu * std::abs(F_n) + 1e-5 * c.F.norm());  // spring and damper may cancel
            slid += F_t > 0.99 * mu * std::abs(F_n);
        }
    }
    CHECK(slid > 1000);
}

TEST_CASE("floor and walls carry the weight of a bed at rest (long)", "[granular][invariant]")
{
    RandomNumbers random{std::mt19937(11)};
    constexpr int n = 9;
    World world(box(width_of(n), width_of(n) + 4 * R), {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.1, 0.4));
    add_walls(world, width_of(n));
    double weight = 0;
    for (Particle p : heap(n, 0.3, random)) {
        p.v = {0, 0, 0};
        world.add(p);
        weight += 9.81 * 2500 * 4 / 3 * std::numbers::pi * p.radius * p.radius * p.radius;
    }
    world.step(60000);
    double up = 0;  // mean over 20 ms, because residual oscillations remain
    constexpr int looks = 100;
    for (int k = 0; k < looks; ++k) {
        world.step(40);
        for (int b = 0; b < 5; ++b) up -= world.wrench(b).F.z / looks;
    }
    CHECK(up == Approx(weight).epsilon(2e-3));
    // a particle may continue to rotate, since no law resists rolling
    double moving = 0;
    for (const Particle& p : world.particles()) moving += 0.5 * p.mass * p.v.dot(p.v);
    CHECK(moving < 1e-6 * weight * width_of(n));
}

TEST_CASE("an elastic gas conserves energy", "[granular][invariant]")
{
    RandomNumbers random{std::mt19937(13)};
    constexpr int n = 5;
    const double width = width_of(n);
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = {width, width, width};
    o.periodic = {true, true, true}, o.gravity = {0, 0, 0};
    o.h = 2e-6;
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 1));
    for (Particle p : heap(n, 0.4, random)) {
        p.omega = {0, 0, 0};
        world.add(p);
    }
    const double E_eff = granular::effective_modulus(glass(), glass());
    const auto energy = [&] {
        const auto all = world.particles();
        double E = world.kinetic_energy();
        for (const ContactRecord& c : world.contacts()) {
            const double R_eff = all[c.i].radius * all[c.j].radius / (all[c.i].radius + all[c.j].radius);
            E += 8. / 15 * E_eff * std::sqrt(R_eff) * std::pow(c.delta, 2.5);
        }
        return E;
    };
    world.step();
    const double before = energy();
    std::size_t contacts = 0;
    for (int k = 0; k < 200; ++k) {
        world.step(200);
        contacts += world.contacts().size();
        CHECK(energy() == Approx(before).epsilon(2e-3));
    }
    CHECK(contacts > 200);
}

TEST_CASE("a mirrored or reordered world has the same motion", "[granular][invariant]")
{
    constexpr int n = 6;
    const double width = width_of(n);
    const auto run = [&](bool mirrored, bool backwards) {
        RandomNumbers random{std::mt19937(17)};
        WorldOptions o = box(width, width + 4 * R);
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.8, 0.3));
        add_walls(world, width);
        std::vector<Particle> all = heap(n, 0.3, random);
        for (Particle& p : all)
            if (mirrored)
                p.r.x = width - p.r.x, p.v.x = -p.v.x, p.omega.y = -p.omega.y, p.omega.z = -p.omega.z;
        if (backwards) std::reverse(all.begin(), all.end());
        for (const Particle& p : all) world.add(p);
        world.step(1000);
        std::vector<Particle> out = world.particles();
        if (backwards) std::reverse(out.begin(), out.end());
        for (Particle& p : out)
            if (mirrored) p.r.x = width - p.r.x, p.v.x = -p.v.x;
        return out;
    };
    const auto plain = run(false, false);
    const auto far = [&](const std::vector<Particle>& other) {
        double most = 0;
        for (std::size_t k = 0; k < plain.size(); ++k)
            most = std::max(most, (plain[k].r - other[k].r).norm());
        return most / R;
    };
    // Each collision amplifies rounding errors about ten times.
    CHECK(far(run(true, false)) < 1e-5);
    CHECK(far(run(false, true)) < 1e-5);
    CHECK(far(run(true, true)) < 1e-5);
}

TEST_CASE("a periodic domain that is too narrow is refused with the width that is sufficient", "[granular]")
{
    const auto insert = [](double width) {
        WorldOptions o;
        o.low = {0, 0, 0}, o.high = {width, 0.1, 0.1};
        o.periodic = {true, false, false};
        o.h = 1e-6;
        World world(o, {glass()});
        world.set_law(0, 0, hertz_mindlin(glass(), 0.8, 0.3));
        Particle p;
        p.r = {1e-3, 0.05, 0.05}, p.radius = 1e-3;
        world.add(p);
        world.step(1);
    };
    CHECK_THROWS_WITH(insert(0.00215),
                      "domain: must be at least 0.0022002 m wide along x, a periodic axis: the largest "
                      "diameter and the skin, got 0.00215");
    insert(0.0022002);
}

}  // namespace world_test
