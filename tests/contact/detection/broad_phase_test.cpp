// SPDX-License-Identifier: GPL-3.0-or-later
// Cells against all pairs, and pairs that are remembered.
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

TEST_CASE("cells find the pairs that a search of all pairs finds and in the same order", "[contact][broad]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u);
    const double smallest = GENERATE(0.05, 0.1), margin = GENERATE(0., 0.02);
    Cloud cloud = random_cloud(seed, 300, 0.6, smallest, 0.1);
    cloud.reach[7] = cloud.reach[200] = infinite;  // big: with all balls but not with one another
    cloud.reach[11] = -1;                          // takes no part
    BroadPhase cells;
    const auto& found = cells.find(cloud.centre, cloud.reach, margin);
    CHECK(found.size() > 800);
    CHECK(found == cloud.all_pairs(margin));
}

TEST_CASE("balls on the borders of cells and far from the origin have their neighbours", "[contact][broad]")
{
    // a lattice with the pitch of a diameter, so that whole rows lie on borders, and touch within rounding
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

TEST_CASE("a broad phase takes points and clouds that have flown apart and nothing at all",
          "[contact][broad]")
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

TEST_CASE("a broad phase refuses what is no reach and no margin and reports a ball that is nowhere",
          "[contact][broad]")
{
    BroadPhase cells;
    const std::vector<Vec3> at = {Vec3::Zero(), Vec3(NAN, 0, 0)};
    const std::vector<double> balls = {1, 1}, big = {1, infinite}, none = {1, NAN};
    CHECK_THROWS_WITH(cells.find(at, balls, 0), "contact::BroadPhase: the centre of body 1 is not finite");
    CHECK(cells.find(at, big, 0).size() == 1);  // a floor has no centre
    CHECK_THROWS_WITH(cells.find(at, none, 0), "contact::BroadPhase: a reach must be a number, got nan");
    CHECK_THROWS_WITH(cells.find(at, big, -1),
                      "contact::BroadPhase: the margin must be finite and not negative, got -1");
    CHECK_THROWS_AS(cells.find(at, std::vector<double>{1}, 0), lie::InvalidInput);
}

TEST_CASE("a search that has grown its buffers takes nothing from the heap", "[contact][broad][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("not counted: a sanitizer owns the heap");
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

TEST_CASE("a crowd finds every pair within its margin at every step and remembers those that stay near",
          "[contact][broad]")
{
    tests::Random random(6);
    Balls neighbors;
    neighbors.margin = 0.02;
    const int small = neighbors.add(ball(0.1)), large = neighbors.add(ball(0.15));
    const int floor = neighbors.add({{}, {std::make_shared<contact::Plane>()}});
    neighbors.set(small, small, std::make_unique<Law>(Law{1}));
    neighbors.set(large, small, std::make_unique<Law>(Law{2}));
    neighbors.set(large, large, std::make_unique<Law>(Law{3}));
    neighbors.set(large, floor, std::make_unique<Law>(Law{4}));  // the small ones fall through

    std::vector<Motion> body;
    std::vector<int> kind;
    for (int b = 0; b < 60; ++b) {
        Motion m;
        m.r = random.vector(0.5);
        m.rdot = random.vector(1);
        kind.push_back(b == 30 ? floor : b % 3 == 0 ? large : small);
        neighbors.enter(b, kind.back());
        body.push_back(m);
    }
    std::map<std::pair<int, int>, int> near;  // steps since they came near
    for (int step = 0; step < 200; ++step) {
        for (Motion& m : body) m.r += 1e-3 * m.rdot;
        std::set<std::pair<int, int>> listed;
        for (auto& p : neighbors.find(body)) {
            ++p.state.steps;
            CHECK(listed.insert(std::minmax(p.i, p.j)).second);
            const int ki = kind[p.i], kj = kind[p.j];
            CHECK(p.law->number == (kj == floor ? 4 : ki == small ? 1 : kj == small ? 2 : 3));
        }
        std::map<std::pair<int, int>, int> now;
        for (int i = 0; i < 60; ++i)
            for (int j = i + 1; j < 60; ++j) {
                if (kind[i] == floor || kind[j] == floor) continue;
                const double R = (kind[i] == large ? 0.15 : 0.1) + (kind[j] == large ? 0.15 : 0.1);
                if ((body[i].r - body[j].r).norm() >= R + 0.02) continue;
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

TEST_CASE("a crowd says what is wrong with a kind", "[contact][broad]")
{
    Balls neighbors;
    const int floor = neighbors.add({{}, {std::make_shared<contact::Plane>()}}),
              small = neighbors.add(ball(0.1));
    const auto law = [] { return std::make_unique<Law>(); };
    CHECK_THROWS_WITH(neighbors.set(floor, floor, law()),
                      "contact::Crowd: one of two kinds that meet must have a finite reach, got inf");
    CHECK_THROWS_WITH(neighbors.set(floor, 2, law()), "contact::Crowd: no kind has this number, got 2");
    neighbors.set(small, floor, law());
    CHECK_THROWS_WITH(neighbors.set(floor, small, law()),
                      "contact::Crowd: two kinds have one law, and these have it already; kind, got 1");
    CHECK_THROWS_WITH(neighbors.add(BodyType{{}, {}, 0}),
                      "contact::Crowd: the reach of a kind must be positive, got 0");
}

TEST_CASE("compliant contacts that come and go are those that were there all the time (long)",
          "[contact][broad][scene]")
{
    // Five balls tumble over each other and the floor: once with every pair named, once with the pairs that are found.
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
    found.between("balls", ball, ball, law, friction);
    found.between("floor", ball, floor, law, friction);
    for (const Motion& m : start) found.enter(ball, m);
    found.enter(floor, Motion{});
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
    CHECK(least < most);  // of the 15 pairs
    for (int b = 0; b < 5; ++b) {
        CHECK(found.body[b].r == named.body[b].r);
        CHECK(found.body[b].omega_bar == named.body[b].omega_bar);
    }
}
