// SPDX-License-Identifier: GPL-3.0-or-later
// Broad phase against a search of all pairs; neighbour list with states of the pairs.
#include "contact/detection/broad_phase.hpp"

#include "contact/detection/neighbor_list.hpp"
#include "contact/scenes/scene.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/check.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>

using namespace hilda;
using contact::BodyType;
using contact::BroadPhase;
using contact::Candidate;
using lie::Motion;
using lie::Vec3;

namespace Catch {
template <>
struct StringMaker<Candidate> {
    static std::string convert(const Candidate& c) { return std::to_string(c.i) + '-' + std::to_string(c.j); }
};
}  // namespace Catch

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Cloud {
    std::vector<Vec3> centre;
    std::vector<double> reach;

    std::vector<Candidate> all_pairs(double margin) const
    {
        std::vector<Candidate> out;
        const int n = static_cast<int>(centre.size());
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j) {
                const double a = reach[i], b = reach[j];
                if (a < 0 || b < 0 || (std::isinf(a) && std::isinf(b))) continue;
                const double near = a + b + margin;
                if (std::isinf(near) || (centre[i] - centre[j]).squaredNorm() < near * near)
                    out.push_back({i, j});
            }
        return out;
    }
};

Cloud random_cloud(unsigned seed, int n, double size, double smallest, double largest)
{
    tests::Random random(seed);
    Cloud cloud;
    for (int b = 0; b < n; ++b) {
        cloud.centre.push_back(random.vector(size));
        cloud.reach.push_back(random.number(smallest, largest));
    }
    return cloud;
}

}  // namespace

TEST_CASE("the broad phase finds the same pairs in the same order as a search of all pairs",
          "[contact][broad]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u);
    const double smallest = GENERATE(0.05, 0.1), margin = GENERATE(0., 0.02);
    Cloud cloud = random_cloud(seed, 300, 0.6, smallest, 0.1);
    cloud.reach[7] = cloud.reach[200] = infinite;  // unbounded: pairs with all balls but not with each other
    cloud.reach[11] = -1;                          // ignored
    BroadPhase cells;
    const auto& found = cells.find(cloud.centre, cloud.reach, margin);
    CHECK(found.size() > 800);
    CHECK(found == cloud.all_pairs(margin));
}

TEST_CASE("the cost of the broad phase does not grow with the ratio of the sizes", "[contact][broad]")
{
    const double ratio = GENERATE(1., 10., 1e4, 1e9);
    // balls of 1 cm in a layer on a floor, and others of all sizes between them and the floor
    Cloud cloud = random_cloud(5, 2000, 0.5, 0.005, 0.005);
    for (Vec3& r : cloud.centre) r.z() *= 0.02;
    const size_t balls = cloud.centre.size();
    for (double size = 0.005; size <= 0.005 * ratio; size *= 10) {
        cloud.centre.push_back(Vec3(0, 0, -size));
        cloud.reach.push_back(size);
    }
    BroadPhase cells;
    const auto& found = cells.find(cloud.centre, cloud.reach, 1e-3);
    CHECK(found == cloud.all_pairs(1e-3));
    CHECK(cells.tests < static_cast<long>(20 * balls + balls * (cloud.centre.size() - balls)));
}

TEST_CASE("the broad phase finds neighbours on cell borders and far from the origin", "[contact][broad]")
{
    // a lattice with the spacing of a diameter: whole rows lie on cell borders, and the balls touch to
    // round-off
    const double offset = GENERATE(0., -0.3, 1e5, 1e14);
    Cloud cloud;
    for (int x = -3; x < 3; ++x)
        for (int y = -3; y < 3; ++y)
            for (int z = -3; z < 3; ++z) {
                cloud.centre.push_back(Vec3(0.2 * x + offset, 0.2 * y, 0.2 * z - offset));
                cloud.reach.push_back(0.1);
            }
    BroadPhase cells;
    for (const double margin : {0., 1e-12, 0.083})
        CHECK(cells.find(cloud.centre, cloud.reach, margin) == cloud.all_pairs(margin));
}

TEST_CASE("the broad phase accepts no bodies, points and widely separated bodies", "[contact][broad]")
{
    BroadPhase cells;
    CHECK(cells.find({}, {}, 0).empty());
    const Cloud points{{Vec3(0, 0, 0), Vec3(1e-3, 0, 0), Vec3(1, 0, 0)}, {0, 0, 0}};
    CHECK(cells.find(points.centre, points.reach, 2e-3) == points.all_pairs(2e-3));
    CHECK(cells.find(points.centre, points.reach, 0).empty());
    Cloud apart = random_cloud(4, 50, 0.3, 0.1, 0.1);
    apart.centre[3] = Vec3(1e300, -1e300, 0);
    apart.centre[5] = Vec3(1e300, -1e300, 0);
    CHECK(cells.find(apart.centre, apart.reach, 0) == apart.all_pairs(0));
}

TEST_CASE("the broad phase rejects invalid reaches, margins and positions", "[contact][broad]")
{
    BroadPhase cells;
    const std::vector<Vec3> at = {Vec3::Zero(), Vec3(NAN, 0, 0)};
    const std::vector<double> balls = {1, 1}, big = {1, infinite}, none = {1, NAN};
    CHECK_THROWS_WITH(cells.find(at, balls, 0), "contact::BroadPhase: the centre of body 1 is not finite");
    CHECK(cells.find(at, big, 0).size() == 1);  // the centre of an unbounded body is not used
    CHECK_THROWS_WITH(cells.find(at, none, 0),
                      "contact::BroadPhase: the reach of a body must be a number, got nan");
    CHECK_THROWS_WITH(cells.find(at, big, -1),
                      "contact::BroadPhase: the margin must be finite and not negative, got -1");
    CHECK_THROWS_AS(cells.find(at, std::vector<double>{1}, 0), lie::InvalidInput);
}

TEST_CASE("a repeated broad phase does not allocate memory", "[contact][broad][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted: a sanitizer replaces malloc");
        return;
    }
    const Cloud cloud = random_cloud(5, 500, 0.6, 0.05, 0.1);
    BroadPhase cells;
    cells.find(cloud.centre, cloud.reach, 0.01);
    CHECK(tests::allocations_during([&] { cells.find(cloud.centre, cloud.reach, 0.01); }) == 0);
}

namespace {

struct Law {
    int number;
};
struct Counted {
    int steps = 0;
};
using Balls = contact::NeighborList<Law, Counted>;

BodyType ball(double R) { return {{1, lie::Mat3::Identity()}, {std::make_shared<contact::Sphere>(R)}, R}; }

}  // namespace

TEST_CASE("a neighbour list contains all pairs that overlap at each step and preserves their states",
          "[contact][broad]")
{
    tests::Random random(6);
    Balls neighbors;
    const int small = neighbors.add_type(ball(0.1)), large = neighbors.add_type(ball(0.15));
    const int floor = neighbors.add_type({{}, {std::make_shared<contact::Plane>()}});
    neighbors.set_law(small, small, std::make_unique<Law>(Law{1}));
    neighbors.set_law(large, small, std::make_unique<Law>(Law{2}));
    neighbors.set_law(large, large, std::make_unique<Law>(Law{3}));
    neighbors.set_law(large, floor,
                      std::make_unique<Law>(Law{4}));  // no law for the small balls and the floor

    std::vector<Motion> body;
    std::vector<int> type;
    for (int b = 0; b < 60; ++b) {
        Motion m;
        m.r = random.vector(0.5);
        m.rdot = random.vector(1);
        type.push_back(b == 30 ? floor : b % 3 == 0 ? large : small);
        neighbors.add_body(b, type.back());
        body.push_back(m);
    }
    std::map<std::pair<int, int>, int> near;  // number of steps with an overlap
    for (int step = 0; step < 200; ++step) {
        for (Motion& m : body) m.r += 1e-3 * m.rdot;
        std::set<std::pair<int, int>> listed;
        for (auto& p : neighbors.find(body)) {
            ++p.state.steps;
            CHECK(listed.insert(std::minmax(p.i, p.j)).second);
            const int ki = type[p.i], kj = type[p.j];
            CHECK(p.law->number == (kj == floor ? 4 : ki == small ? 1 : kj == small ? 2 : 3));
        }
        std::map<std::pair<int, int>, int> now;
        for (int i = 0; i < 60; ++i)
            for (int j = i + 1; j < 60; ++j) {
                if (type[i] == floor || type[j] == floor) continue;
                const double R = (type[i] == large ? 0.15 : 0.1) + (type[j] == large ? 0.15 : 0.1);
                if ((body[i].r - body[j].r).norm() >= R) continue;
                REQUIRE(listed.count({i, j}) == 1);
                now[{i, j}] = near.count({i, j}) != 0 ? near[{i, j}] + 1 : 1;
            }
        near = now;
        for (const auto& p : neighbors.pair())
            if (const auto at = near.find(std::minmax(p.i, p.j)); at != near.end())
                CHECK(p.state.steps >= at->second);
    }
    CHECK(near.size() > 20);
}

TEST_CASE("a neighbour list rejects invalid body types and laws", "[contact][broad]")
{
    Balls neighbors;
    const int floor = neighbors.add_type({{}, {std::make_shared<contact::Plane>()}}),
              small = neighbors.add_type(ball(0.1));
    const auto law = [] { return std::make_unique<Law>(); };
    CHECK_THROWS_WITH(
        neighbors.set_law(floor, floor, law()),
        "contact::NeighborList: one of the two body types of a law must have a finite reach, got inf");
    CHECK_THROWS_WITH(neighbors.set_law(floor, 2, law()),
                      "contact::NeighborList: there is no body type with this number, got 2");
    neighbors.set_law(small, floor, law());
    CHECK_THROWS_WITH(
        neighbors.set_law(floor, small, law()),
        "contact::NeighborList: a pair of body types must have one law only; law set again for type, got 1");
    CHECK_THROWS_WITH(neighbors.add_type(BodyType{{}, {}, 0}),
                      "contact::NeighborList: the reach of a body type must be positive, got 0");
}

TEST_CASE("contacts of a neighbour list give the same motion as permanent contacts (long)",
          "[contact][broad][scene]")
{
    // Five balls fall on each other and on the floor: with all pairs listed, and with the pairs of the
    // neighbour list.
    const double R = 0.1;
    const contact::Shape sphere{std::make_shared<contact::Sphere>(R)},
        plane{std::make_shared<contact::Plane>()};
    const contact::Inertia inertia{1, 0.4 * R * R * lie::Mat3::Identity()};
    const auto law = std::make_shared<contact::Hertz>(1e6, 0.5);
    const auto friction =
        contact::friction_law("slide-roll-spin").make({.mu_s = 0.3, .mu_k = 0.25, .K_E = 2e4, .eta_r = 0.1});
    std::vector<Motion> start(5);
    for (int b = 0; b < 5; ++b) {
        start[b].r = Vec3(0.15 * (b % 2), 0.03 * b, R + 0.17 * b);
        start[b].rdot = Vec3(1 - b, 0.1, 0);
    }
    contact::Scene named, found;
    for (const Motion& m : start) named.add(inertia, m);
    named.add(contact::Inertia{}, Motion{});
    for (int i = 0; i < 5; ++i) {
        for (int j = i + 1; j < 5; ++j) named.add("balls", i, sphere, j, sphere, law, friction);
        named.add("floor", i, sphere, 5, plane, law, friction);
    }
    const int ball = found.add(BodyType{inertia, sphere, R}), floor = found.add(BodyType{{}, plane});
    found.set_contact_law("balls", ball, ball, law, friction);
    found.set_contact_law("floor", ball, floor, law, friction);
    for (const Motion& m : start) found.add_body(ball, m);
    found.add_body(floor, Motion{});
    const double h = 1e-4;
    named.check(h);
    found.check(h);
    CHECK_THROWS_WITH(found.check(1), Catch::Contains("the step must not exceed its stability bound"));

    size_t most = 0, least = 100;
    for (int n = 0; n < 5000; ++n) {
        named.step(h);
        found.step(h);
        most = std::max(most, found.neighbors.pair().size());
        least = std::min(least, found.neighbors.pair().size());
    }
    CHECK(least < most);  // the list changes; there are 15 pairs
    for (int b = 0; b < 5; ++b) {
        CHECK(found.body[b].r == named.body[b].r);
        CHECK(found.body[b].omega_bar == named.body[b].omega_bar);
    }
}
