// SPDX-License-Identifier: GPL-3.0-or-later
// Insertion of particles during a run: regions, amounts, places without contact, blocked insertions, masses.
#include "granular/insertion/insertion.hpp"
#include "granular/insertion/obstacles.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::Insertion;
using granular::InsertionBlocked;
using granular::InsertionFlow;
using granular::InsertionRegion;
using granular::Insertions;
using granular::InsertionSpec;
using granular::Random;
using granular::Share;
using granular::Sizes;

namespace {

constexpr double R = 1e-3;

WorldOptions options(double side = 0.04)
{
    WorldOptions o;
    o.low = {0, 0, 0}, o.high = {side, side, side};
    o.gravity = {0, 0, 0};
    o.h = 1e-5;
    return o;
}

World with_law(const WorldOptions& o)
{
    World world(o, {glass()});
    world.set_law(0, 0, hertz_mindlin(glass(), 0.5, 0.3));
    return world;
}

InsertionSpec in_box(const Vec3& low, const Vec3& high)
{
    InsertionSpec s;
    s.name = "feed";
    s.region.low = low, s.region.high = high;
    s.sizes = Sizes(R);
    s.density = glass().density;
    return s;
}

double sphere_mass(double radius) { return 4. / 3 * M_PI * radius * radius * radius * glass().density; }

InsertionRegion region_of(const std::string& members)
{
    const io::JsonSource source("{" + members + "}", "file");
    return granular::read_region({source, source.root, ""}, R);
}

std::string refusal_of_region(const std::string& members)
{
    try {
        region_of(members);
    } catch (const io::InvalidInput& e) {
        return e.what();
    }
    return "nothing";
}

}  // namespace

TEST_CASE("centres are uniformly distributed over a region that contains the whole particles",
          "[granular][insertion]")
{
    Random random(7);
    const auto mean = [&](const InsertionRegion& region, const auto& f) {
        constexpr int n = 20000;
        double sum = 0;
        for (int k = 0; k < n; ++k) sum += f(region.centre(R, random));
        return sum / n;
    };
    const auto box =
        region_of(R"("type": "box", "low": [0, 0.01, 0.02], "high": [0.01, 0.03, 0.0220000001])");
    CHECK(mean(box, [](const Vec3& c) { return c.x; }) == Approx(5e-3).epsilon(0.02));
    CHECK(mean(box, [](const Vec3& c) { return std::pow(c.x - 5e-3, 2); }) ==
          Approx(8e-3 * 8e-3 / 12).epsilon(0.04));
    CHECK(mean(box, [](const Vec3& c) { return c.z; }) == Approx(0.021).epsilon(1e-8));

    const auto cylinder =
        region_of(R"("type": "cylinder", "r": [1, 2, 3], "axis": [0, 3, 4], "radius": 0.02, "length": 0.1)");
    const Vec3 axis{0, 0.6, 0.8};
    const auto along = [&](const Vec3& c) { return (c - cylinder.r).dot(axis); };
    const auto across = [&](const Vec3& c) {
        const Vec3 d = c - cylinder.r;
        return (d - d.dot(axis) * axis).norm();
    };
    double farthest = 0, low = 1, high = 0;
    const auto [from, to] = cylinder.bounds(R);
    for (int k = 0; k < 10000; ++k) {
        const Vec3 c = cylinder.centre(R, random);
        farthest = std::max(farthest, across(c)), low = std::min(low, along(c)),
        high = std::max(high, along(c));
        for (const auto& [x, a, b] :
             {std::tuple{c.x, from.x, to.x}, {c.y, from.y, to.y}, {c.z, from.z, to.z}})
            REQUIRE((x - R >= a - 1e-12 && x + R <= b + 1e-12));
    }
    CHECK(farthest <= 0.019 + 1e-12);
    CHECK(farthest > 0.0189);
    CHECK(low >= R - 1e-12);
    CHECK(high <= 0.099 + 1e-12);
    CHECK(mean(cylinder, along) == Approx(0.05).epsilon(0.02));
    CHECK(mean(cylinder, [&](const Vec3& c) { return std::pow(across(c), 2); }) ==
          Approx(0.019 * 0.019 / 2).epsilon(0.03));

    const auto disk = region_of(R"("type": "disk", "r": [0, 0, 0.5], "normal": [0, 0, -2], "radius": 0.01)");
    for (int k = 0; k < 100; ++k) REQUIRE(disk.centre(R, random).z == 0.5);
    CHECK(disk.bounds(R).first == Vec3{-0.011, -0.011, 0.499});
    CHECK(disk.description() == "disk of radius 0.01 around (0, 0, 0.5) with the normal (0, 0, -1)");
}

TEST_CASE("a region without place for a particle is refused", "[granular][insertion]")
{
    const std::pair<const char*, const char*> wrong[] = {
        {R"("type": "ball")", "(/type): unknown type"},
        {R"("type": "box", "low": [0, 0, 0], "high": [0.1, 0.0019, 0.1])",
         "(/high/1): high must be at least a diameter, 0.002, above low, 0, got 0.0019"},
        {R"("type": "disk", "r": [0, 0, 0], "normal": [0, 0, 1], "radius": 5e-4)",
         "(/radius): radius must be at least 0.001, so that the largest particle has place, got 5e-04"},
        {R"("type": "disk", "r": [0, 0, 0], "normal": [0, 0, 0], "radius": 0.01)",
         "(/normal): normal must have a direction"},
        {R"("type": "cylinder", "r": [0, 0, 0], "axis": [0, 0, 1], "radius": 0.01, "length": 1e-3)",
         "(/length): length must be at least 0.002, so that the largest particle has place, got 0.001"},
        {R"("type": "disk", "r": [0, 0, 0], "normal": [0, 0, 1], "radius": 0.01, "length": 1)", "length"}};
    for (const auto& [members, message] : wrong) {
        INFO(members);
        CHECK_THAT(refusal_of_region(members), Catch::Contains(message));
    }
}

TEST_CASE("particles are inserted at their rate, without contact, between two times", "[granular][insertion]")
{
    const auto o = options();
    World world = with_law(o);
    Insertions insertions;
    InsertionSpec s = in_box({0.01, 0.01, 0.01}, {0.03, 0.03, 0.03});
    s.flow.rate = 2e4, s.from = 1e-3, s.flow.to = 6e-3, s.first_step = 100, s.interval = 50;
    s.flow.v = {0, 0, -1};
    insertions.all.emplace_back(s);
    insertions.start(world, 1);
    for (int k = 0; k <= 1000; ++k) {
        // before the steps 100, 150, ... the particles are inserted that are due until then
        const int intervals = (k - 1) / 50;
        const double until = std::min(intervals * 50 * o.h, s.flow.to);
        const auto due = k > 100 ? std::lround(s.flow.rate * (until - s.from)) : 0;
        REQUIRE(world.count() == static_cast<std::size_t>(due));
        REQUIRE(insertions.count() == due);
        world.step();
    }
    CHECK(insertions.mass() == Approx(100 * sphere_mass(R)).epsilon(1e-7));
    for (const Particle& p : world.particles()) CHECK((p.v == s.flow.v && p.radius == static_cast<float>(R)));
    CHECK(world.watch().largest_overlap == 0);
}

TEST_CASE("inserted clumps have the mass flow of the insertion and touch nothing", "[granular][insertion]")
{
    WorldOptions o = options();
    o.periodic = {true, false, false};
    World world = with_law(o);
    const granular::ClumpTemplate rod = granular::solid_clump(
        "rod", {{{0, 0, 0}, R}, {{1.5e-3, 0, 0}, R}, {{3e-3, 0, 0}, R}}, glass().density);
    InsertionSpec s = in_box({0, 0, 0}, {0.04, 0.02, 0.02});
    s.clumps.shape = world.add_template(rod);
    s.clumps.of = rod, s.clumps.radius = rod.bounding_radius();
    s.sizes = Sizes({{1.5e-3, 3e-3, 1}}, Share::of_number);
    s.density = rod.mass / granular::sphere_volume(s.clumps.radius);
    s.flow.mass_rate = 60 * rod.mass / 1e-2, s.interval = 10;
    Insertions insertions;
    insertions.all.emplace_back(s);
    insertions.start(world, 1e-2);
    world.step(1001);
    const std::vector<granular::Clump> clumps = world.clumps();
    REQUIRE(clumps.size() == static_cast<std::size_t>(insertions.count()));
    CHECK(clumps.size() > 60);  // they are smaller than the template
    CHECK(world.count() == 3 * clumps.size());
    double mass = 0, least = 1, largest = 0;
    Vec3 mean_axis{0, 0, 0};
    for (const granular::Clump& c : clumps) {
        mass += c.mass, least = std::min(least, c.scale), largest = std::max(largest, c.scale);
        const granular::EulerParameters<double> p{c.e[0], {c.e[1], c.e[2], c.e[3]}};
        mean_axis += (1. / static_cast<double>(clumps.size())) * granular::rotated(p, Vec3{1, 0, 0});
    }
    CHECK(mass == Approx(insertions.mass()).epsilon(1e-6));
    CHECK(std::abs(mass - s.flow.mass_rate * 1e-2) < rod.mass);
    CHECK(least < 1.1 * 1.5e-3 / s.clumps.radius);
    CHECK(largest > 0.9 * 3e-3 / s.clumps.radius);
    CHECK(mean_axis.norm() < 0.3);  // isotropic: its deviation is 1/√n
    CHECK(world.contacts().empty());
    for (const Particle& p : world.particles()) CHECK((p.r.y >= p.radius && p.r.z >= p.radius));
}

TEST_CASE("an inserted clump of one sphere has the bits of an inserted particle", "[granular][insertion]")
{
    const auto run = [](bool clumps) {
        WorldOptions o = options(0.02);
        o.periodic = {true, true, false}, o.high.z = 0.05;
        o.gravity = {0, 0, -9.81};
        World world = with_law(o);
        world.add(Boundary());  // the plane z = 0
        InsertionSpec s = in_box({0, 0, 0.01}, {0.02, 0.02, 0.02});
        if (clumps) {
            const granular::ClumpTemplate ball =
                granular::solid_clump("ball", {{{0, 0, 0}, R}}, glass().density);
            s.clumps.shape = world.add_template(ball);
            s.clumps.of = ball, s.clumps.radius = ball.bounding_radius(), s.clumps.orientation = {1, 0, 0, 0};
        }
        s.flow.rate = 5000, s.flow.random_v = 0.3, s.interval = 20;
        Insertions insertions;
        insertions.all.emplace_back(s);
        insertions.start(world, 0.03);
        world.step(3000);
        return world.particles();
    };
    const std::vector<Particle> one = run(false), other = run(true);
    REQUIRE(one.size() > 100);
    REQUIRE(one.size() == other.size());
    for (std::size_t k = 0; k < one.size(); ++k)
        CHECK((one[k].r == other[k].r && one[k].v == other[k].v && one[k].omega == other[k].omega));
}

TEST_CASE("a random velocity has the given magnitude and no preferred direction", "[granular][insertion]")
{
    World world = with_law(options());
    Insertions insertions;
    InsertionSpec s = in_box({0.001, 0.001, 0.001}, {0.039, 0.039, 0.039});
    s.count = 800, s.flow.v = {0, 0, -1}, s.flow.random_v = 0.2;
    insertions.all.emplace_back(s);
    insertions.start(world, 1);
    world.step();
    REQUIRE(world.count() == 800);
    Vec3 mean{0, 0, 0};
    for (const Particle& p : world.particles()) {
        REQUIRE((p.v - s.flow.v).norm() == Approx(0.2).epsilon(1e-6));
        mean += (1. / 800) * (p.v - s.flow.v);
    }
    CHECK(mean.norm() < 4 * 0.2 / std::sqrt(800.));
}

TEST_CASE("the inserted mass follows a mass rate to half a particle", "[granular][insertion]")
{
    World world = with_law(options());
    Insertions insertions;
    InsertionSpec s = in_box({0.001, 0.001, 0.001}, {0.039, 0.039, 0.039});
    s.sizes = Sizes({{5e-4, 1.5e-3, 1}}, Share::of_mass);
    s.flow.mass_rate = 0.05, s.interval = 100, s.count = 500;
    insertions.all.emplace_back(s);
    insertions.start(world, 1);
    for (int k = 0; k < 20; ++k) {
        world.step(100);
        CHECK(std::abs(insertions.mass() - s.flow.mass_rate * 100 * k * 1e-5) <= sphere_mass(1.5e-3) / 2);
    }
    CHECK(insertions.count() > 50);
    CHECK(static_cast<double>(insertions.count()) <= s.largest_count(19 * 1e-3));
    double inside = 0;
    for (const Particle& p : world.particles()) inside += p.mass;
    CHECK(insertions.mass() == Approx(inside).epsilon(1e-14));
    world.step(20000);
    CHECK(insertions.count() == 500);
}

TEST_CASE("an insertion does not change the other particles by a bit", "[granular][insertion]")
{
    const granular::Scheme scheme = GENERATE(granular::Scheme::symplectic_euler, granular::Scheme::chung);
    auto o = options();
    o.gravity = {0.3, 0.2, -9.81}, o.scheme = scheme, o.orientation = true;
    const auto run = [&](std::int64_t count) {
        World world = with_law(o);
        Boundary floor;
        floor.r = {0, 0, 0.001};
        world.add(floor);
        for (int k = 0; k < 12; ++k) {
            const int row = k / 3 % 2, layer = k / 6;
            world.add(
                Particle{.r = {0.005 + 0.00199 * (k % 3), 0.005 + 0.002 * row, 0.0025 + 0.0019999 * layer},
                         .radius = R,
                         .v = {0.1, 0.01 * k, 0},
                         .omega = {1. * k, 2, 3}});
        }
        Insertions insertions;
        InsertionSpec s = in_box({0.02, 0.02, 0.02}, {0.038, 0.038, 0.038});
        s.count = count, s.first_step = 37, s.flow.rate = 1e4, s.from = 37e-5, s.interval = 31;
        insertions.all.emplace_back(s);
        insertions.start(world, 1);
        world.step(500);
        CHECK(insertions.count() == std::min(count, std::int64_t{46}));
        auto all = world.particles();
        all.resize(12);
        return all;
    };
    const auto with = run(40), without = run(0);
    for (std::size_t k = 0; k < 12; ++k) {
        CHECK(with[k].r == without[k].r);
        CHECK(with[k].v == without[k].v);
        CHECK(with[k].omega == without[k].omega);
        CHECK(with[k].e == without[k].e);
    }
}

TEST_CASE("particles, boundaries, meshes and images across periodic sides are obstacles",
          "[granular][insertion]")
{
    auto o = options();
    o.periodic = {true, false, false};
    World world = with_law(o);
    Boundary wall, ball, triangles;
    wall.r = {0, 0.001, 0}, wall.axis = {0, 1, 0};
    ball.shape = Boundary::Shape::sphere, ball.radius = 0.004, ball.r = {0.02, 0.02, 0.02};
    triangles.shape = Boundary::Shape::mesh, triangles.r = {0.02, 0.02, 0.03};
    world.add(wall), world.add(ball);
    world.add(triangles,
              {.vertex = {{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0, 0.01, 0}}, .triangle = {{0, 1, 2}}});
    world.add(Particle{.r = {0.001, 0.01, 0.01}, .radius = R});
    world.add(Particle{.r = {0.03, 0.03, 0.01}, .radius = 2 * R, .replica = 1});
    world.step();
    const granular::Obstacles of(world, {0, 0, 0}, {0.04, 0.04, 0.04}, R, 0);
    CHECK(of.touches({0.0029, 0.01, 0.01}, R));
    CHECK_FALSE(of.touches({0.0031, 0.01, 0.01}, R));
    CHECK(of.touches({0.0395, 0.01, 0.01}, R));  // the image at x = 0.041
    CHECK_FALSE(of.touches({0.0389, 0.01, 0.01}, R));
    CHECK_FALSE(of.touches({0.03, 0.03, 0.01}, R));  // of another replica
    CHECK(of.touches({0.01, 0.0019, 0.01}, R));
    CHECK_FALSE(of.touches({0.01, 0.0021, 0.01}, R));
    CHECK(of.touches({0.0249, 0.02, 0.02}, R));
    CHECK_FALSE(of.touches({0.0251, 0.02, 0.02}, R));
    CHECK(of.touches({0.02, 0.02, 0.0309}, R));
    CHECK_FALSE(of.touches({0.02, 0.02, 0.0311}, R));
    CHECK_FALSE(of.touches({0.02, 0.02, 0.0295}, R));  // behind the triangle
    granular::Obstacles more = of;
    more.add({0.0005, 0.03, 0.03}, R);
    CHECK(more.touches({0.039, 0.03, 0.03}, R));
    CHECK(of.touches({0.039, 0.03, 0.03}, R) == false);
}

TEST_CASE("an insertion without place waits, or ends the run with its region and the number of tries",
          "[granular][insertion]")
{
    World world = with_law(options());
    Insertions insertions;
    InsertionSpec s = in_box({0.01, 0.01, 0.01}, {0.015, 0.015, 0.015});
    s.count = 40, s.interval = 10, s.most_tries = 1000;
    SECTION("it waits, and tries again until the limit")
    {
        insertions.all.emplace_back(s);
        insertions.start(world, 1);
        world.step();
        const auto placed = world.count();
        CHECK(placed > 4);
        CHECK(placed < 12);
        const auto advance = [&] { world.step(100); };
        CHECK_THROWS_AS(advance(), InsertionBlocked);
        // the particles that are in the region rest there; 200 tries at each of the steps 0, 10, ..., 40
        CHECK(world.steps() <= 60);
        CHECK(world.steps() >= 40);
        CHECK(world.is_complete());
        CHECK(world.count() == static_cast<std::size_t>(insertions.count()));
        CHECK_THROWS_WITH(
            world.step(),
            Catch::StartsWith("insertion 'feed': no place for a particle of radius 0.001 m in its region, "
                              "a box from (0.01, 0.01, 0.01) to (0.015, 0.015, 0.015), in 1000 tries from"));
    }
    SECTION("refused at once")
    {
        s.postpones = false;
        insertions.all.emplace_back(s);
        insertions.start(world, 1);
        CHECK_THROWS_WITH(world.step(), Catch::Contains("tries from t = 0 s to t = 0 s; it has inserted"));
        CHECK(world.count() == 0);
        CHECK(insertions.count() == 0);
    }
}

TEST_CASE("inserted mass is the mass inside and the mass that has left, also after a restart",
          "[granular][insertion]")
{
    auto o = options();
    o.gravity = {0, 0, -9.81}, o.outflow = {true, true, true, true, true, true};
    struct Feed {
        World world;
        Insertions insertions;
        explicit Feed(const WorldOptions& o) : world(with_law(o))
        {
            InsertionSpec s = in_box({0.001, 0.001, 0.005}, {0.03, 0.03, 0.012});
            s.sizes = Sizes({{5e-4, 1e-3, 1}}, Share::of_mass);
            s.flow.rate = 5000, s.interval = 70, s.flow.v = {0, 0, -0.5}, s.flow.random_v = 0.3;
            insertions.all.emplace_back(s);
            insertions.start(world, 1);
        }
        std::string save()
        {
            return world.to_bytes("run", [&](io::Archive& a) { insertions.transfer(a); });
        }
        double balance() const
        {
            double inside = 0;
            for (const Particle& p : world.particles()) inside += p.mass;
            return inside + world.outflow().mass - insertions.mass();
        }
    };
    Feed whole(o), cut(o), restored(o);
    whole.world.step(4000), cut.world.step(1933);
    const std::string bytes = cut.save();
    restored.world.step(0);
    restored.world.from_bytes(bytes, "run", "file", [&](io::Archive& a) { restored.insertions.transfer(a); });
    restored.world.step(4000 - 1933);
    CHECK(whole.world.outflow().count > 20);
    CHECK(whole.insertions.count() == 199);
    CHECK(std::abs(whole.balance()) < 1e-14 * whole.insertions.mass());
    CHECK(whole.save() == restored.save());
}

TEST_CASE("what is due from a sequence of flows is the sum of their amounts, also after a restart",
          "[granular][insertion]")
{
    const auto o = options();
    InsertionSpec s = in_box({0.001, 0.001, 0.001}, {0.039, 0.039, 0.039});
    struct Feed {
        World world;
        Insertions insertions;
        Feed(const WorldOptions& options, const InsertionSpec& spec) : world(with_law(options))
        {
            insertions.all.emplace_back(spec);
            insertions.start(world, 1);
        }
        void begin(const InsertionFlow& flow) { insertions.all[0].begin_flow(flow, world.t()); }
        std::string save()
        {
            return world.to_bytes("run", [&](io::Archive& a) { insertions.transfer(a); });
        }
    };
    const auto by_rate = [](double rate) {
        InsertionFlow flow;
        flow.rate = rate;
        return flow;
    };
    InsertionFlow off = by_rate(700), until = by_rate(700), by_mass;
    off.active = false, until.to = 15e-4, by_mass.mass_rate = 700 * s.mean_mass();
    const double t = 1e-3;  // of each flow [s]
    // flows, and the number of particles that are due from each
    const std::vector<std::pair<InsertionFlow, double>> sequences[] = {
        {{by_rate(700), 0.7}, {by_rate(2400), 2.4}, {by_rate(700), 0.7}, {by_rate(2400), 2.4}},
        {{by_rate(700), 0.7}, {off, 0}, {by_rate(700), 0.7}, {off, 0}, {by_rate(2400), 2.4}},
        {{by_rate(700), 0.7}, {until, 0.35}, {by_rate(700), 0.7}, {until, 0}, {by_rate(2400), 2.4}},
        {{by_rate(700), 0.7}, {by_mass, 0.7}, {by_rate(700), 0.7}, {by_mass, 0.7}, {by_rate(2400), 2.4}}};
    for (const auto& sequence : sequences) {
        s.flow = sequence[0].first;
        Feed feed(o, s);
        double due = 0;
        for (const auto& [flow, number] : sequence) {
            feed.begin(flow);
            feed.world.step(std::lround(t / o.h));
            Feed restored(o, s);
            restored.world.step(0);
            restored.world.from_bytes(feed.save(), "run", "file",
                                      [&](io::Archive& a) { restored.insertions.transfer(a); });
            CHECK(restored.save() == feed.save());
            due += number;
            feed.begin(by_rate(0.5 * flow.rate + 1)), feed.begin(flow);  // at the same time: no effect
        }
        feed.begin(by_rate(1e-9));
        feed.world.step();
        CHECK(feed.insertions.count() == static_cast<std::int64_t>(std::floor(due + 1e-9)));
    }
}
