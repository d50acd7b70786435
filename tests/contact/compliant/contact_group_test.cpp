// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of contacts by a neighbour list: the same motion as with all pairs, at the cost of the near pairs.
#include <catch2/catch.hpp>

#include "contact/compliant/contact_force.hpp"
#include "contact/compliant/contact_group.hpp"
#include "dae/model_file.hpp"
#include "io/json.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/motion_difference.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

using namespace hilda;

namespace pile_tests {

namespace {

constexpr double R = 0.05;

const std::string laws = R"("normal": {"type": "hertz", "E_star": 1e5, "restitution": 0.7}, )"
                         R"("friction": {"mu_s": 0.4, "mu_k": 0.3, "K_E": 2e3, "eta_r": 0.02})";
const std::string ball = R"({"type": "sphere", "radius": 0.05})";

std::string body(int k, const lie::Vec3& r, const lie::Vec3& v)
{
    const auto list = [](const lie::Vec3& a) {
        return '[' + io::shortest(a[0]) + ", " + io::shortest(a[1]) + ", " + io::shortest(a[2]) + ']';
    };
    return R"({"name": "b)" + std::to_string(k) + R"(", "mass": 0.1, "inertia": [1e-4, 1e-4, 1e-4], "r": )" +
           list(r) + ", \"r_dot\": " + list(v) + '}';
}

std::string model(const std::string& bodies, const std::string& contacts)
{
    return R"({"hilda_model": 1, "name": "pile", "bodies": [)" + bodies + "], \"contacts\": [" + contacts +
           "]}";
}

std::string pair(int i, int j)
{
    return R"({"name": "balls: b)" + std::to_string(i) + "-b" + std::to_string(j) + R"(", "body_i": "b)" +
           std::to_string(i) + R"(", "body_j": "b)" + std::to_string(j) + R"(", "surface_i": )" + ball +
           ", \"surface_j\": " + ball + ", " + laws + '}';
}

/// A cube of n³ balls with random velocities up to v above a floor, each two a contact: as a group, or one by
/// one
std::string cube(int n, double v, bool as_group, double spacing = 2.2 * R)
{
    tests::Random random(7);
    std::string bodies, contacts = R"({"name": "floor", "body_i": "all", "body_j": "ground", "surface_i": )" +
                                   ball + R"(, "surface_j": {"type": "plane"}, )" + laws + '}';
    for (int k = 0; k < n * n * n; ++k) {
        const int row = k / n, layer = row / n;
        bodies += (k > 0 ? ", " : "") +
                  body(k, spacing * lie::Vec3(k % n, row % n, 0.6 + layer), v * random.vector());
    }
    if (as_group)
        contacts += R"(, {"name": "balls", "bodies": "all", "surface": )" + ball + ", " + laws + '}';
    else
        for (int i = 0; i < n * n * n; ++i)
            for (int j = i + 1; j < n * n * n; ++j) contacts += ", " + pair(i, j);
    return model(bodies, contacts);
}

dae::Description started(const std::string& text)
{
    dae::Description d = dae::read_model(text, "pile.json");
    dae::start(d);
    return d;
}

long near_pairs(const dae::Model& model, const lie::State& x)
{
    long count = 0;
    model.near_forces().visit(x, [&](const dae::Force&, int) { ++count; });
    return count;
}

}  // namespace

TEST_CASE("a pile with a neighbour list moves as with all pairs, to the bit (long)",
          "[contact][groups][neighbours]")
{
    const dae::Description all = started(cube(3, 1.5, false)), near = started(cube(3, 1.5, true));
    REQUIRE(all.model->forces().size() == 27 + 351);
    REQUIRE(near.model->forces().size() == 27);
    REQUIRE(near.model->near_forces().pairs() == 351);
    for (const char* name : {"rA-half-1", "rA-half-2", "rA-half-1-momentum"}) {
        CAPTURE(name);
        constexpr double h = 2e-4;
        const auto of_all = lie::scheme(name).make(*all.model, {}),
                   of_near = lie::scheme(name).make(*near.model, {});
        lie::March a(all.x, *of_all, h), b(near.x, *of_near, h);
        const long lists = near.model->near_forces().lists_made;
        double largest = 0;
        long least = 351, most = 0;
        for (int n = 0; n < 3000; ++n) {
            a.advance({}), b.advance({});
            largest = std::max(largest, tests::motion_difference(a.node(), b.node()));
            const long count = near_pairs(*near.model, b.node());
            least = std::min(least, count), most = std::max(most, count);
            if (n == 1000) {  // as from a checkpoint
                lie::State restored = b.node();
                REQUIRE(near.model->fits(restored));
                restored.derived = nullptr;
                b.set_node(restored);
            }
        }
        CHECK(largest == 0);
        CHECK(near.model->potential_energy(b.node()) ==
              Approx(all.model->potential_energy(a.node())).epsilon(1e-14));
        // pairs have come and gone
        CHECK(near.model->near_forces().lists_made > lists + 10);
        CHECK(10 * least < 3 * 351);
        CHECK(most > least);
    }
}

TEST_CASE("bodies that meet and part within a step are found as with all pairs",
          "[contact][groups][neighbours]")
{
    // 15 balls at rest 1 m apart, and one that flies through them by 0.7 m in a step
    for (const bool as_group : {true, false}) {
        std::string bodies = body(0, {-0.35, 0, 0}, {700, 0, 0}), contacts;
        for (int k = 1; k < 16; ++k) bodies += ", " + body(k, {k - 1., 0, 0}, {0, 0, 0});
        if (as_group)
            contacts = R"({"name": "balls", "bodies": "all", "surface": )" + ball + ", " + laws + '}';
        else
            for (int i = 0; i < 16; ++i)
                for (int j = i + 1; j < 16; ++j) contacts += (contacts.empty() ? "" : ", ") + pair(i, j);
        const dae::Description d = started(model(bodies, contacts));
        const auto integrator = lie::scheme("rA-half-1").make(*d.model, {});
        lie::March march(d.x, *integrator, 1e-3);
        CHECK_THROWS_WITH(march.advance({}),
                          Catch::StartsWith("contact 'balls: b0-b1': the bodies pass through "
                                            "each other between t = 0 s and 0.001 s"));
    }
}

TEST_CASE("the cost of a pile grows with its near pairs", "[contact][groups][neighbours]")
{
    struct Counts {
        double bodies, near, tests, states;
    };
    const auto counts = [](int n) {
        const dae::Description d = started(cube(n, 0.1, true, 1.99 * R));
        const auto& group =
            dynamic_cast<const contact::ContactGroup&>(*d.model->near_forces().all_groups().back());
        const long before = group.tests;
        const auto integrator = lie::scheme("rA-half-1").make(*d.model, {});
        lie::March march(d.x, *integrator, 1e-5);
        for (int k = 0; k < 3; ++k) march.advance({});
        return Counts{static_cast<double>(d.model->bodies()),
                      static_cast<double>(near_pairs(*d.model, march.node())), static_cast<double>(before),
                      static_cast<double>(march.node().internal_state.size())};
    };
    const Counts small = counts(5), large = counts(10);
    const double bodies = large.bodies / small.bodies;
    // the surface of a cube has fewer neighbours: at most 9.7 times as many for 8 times the balls
    CHECK(large.near < 1.3 * bodies * small.near);
    CHECK(large.tests < 1.6 * bodies * small.tests);
    CHECK(large.states < 1.3 * bodies * small.states);
    CHECK(large.near < 8 * large.bodies);  // 6 neighbours of each ball of a cube, the floor
}

TEST_CASE("a step of a pile with a kept list does not allocate memory",
          "[contact][groups][neighbours][allocation]")
{
    if (!tests::counts_allocations) return;
    const dae::Description d = started(cube(5, 0, true, 1.995 * R));
    const auto integrator = lie::scheme("rA-half-1").make(*d.model, {});
    lie::March march(d.x, *integrator, 1e-6);
    for (int k = 0; k < 5; ++k) march.advance({});
    const long lists = d.model->near_forces().lists_made;
    CHECK(tests::allocations_during([&] {
              for (int k = 0; k < 20; ++k) march.advance({});
          }) == 0);
    CHECK(d.model->near_forces().lists_made == lists);
}

TEST_CASE("a large group keeps its form in the canonical text, and names its pairs",
          "[contact][groups][neighbours]")
{
    const dae::Description d = started(cube(3, 0, true));
    CHECK(d.model->force_of(27 + 1)->label() == "contact 'balls: b0-b1'");
    CHECK(d.model->force_of(27 + 25 * 27 + 26)->label() == "contact 'balls: b25-b26'");
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(again.model->near_forces().pairs() == 351);
    const std::vector<std::string> deep = {"/bodies/1/r/0=0.03"};
    dae::Description wrong = dae::read_model(cube(3, 0, true), "m.json", deep);
    CHECK_THROWS_WITH(
        dae::start(wrong),
        Catch::Contains("(/contacts/1): contact 'balls: b0-b1': the surfaces must not overlap"));
    const dae::Description pressed = dae::read_model(
        model(
            body(0, {0, 0, 0}, {0, 0, 0}) +
                [] {
                    std::string more;
                    for (int k = 1; k < 16; ++k) more += ", " + body(k, {1. * k, 0., 0.}, {0, 0, 0});
                    return more;
                }(),
            R"({"bodies": "all", "surface": )" + ball + R"(, "normal": {"type": "given", "force": 1}})"),
        "m.json");
    CHECK(pressed.model->forces().size() == 120);  // this force acts at any distance
}

TEST_CASE("pairs of two lists of bodies have one number each", "[contact][groups][neighbours]")
{
    contact::ContactPairs pairs;
    pairs.first = {4, 1, 2}, pairs.second = {2, 3, 4};
    pairs.index();
    std::vector<std::pair<int, int>> all;
    for (int n = 0; n < pairs.numbers(); ++n)
        if (pairs.has(n)) all.push_back(pairs.pair(n));
    CHECK(all == std::vector<std::pair<int, int>>{{4, 2}, {4, 3}, {1, 2}, {1, 3}, {1, 4}, {2, 3}});
    CHECK(pairs.count() == 6);
    CHECK(pairs.first_number() == 0);
}

}  // namespace pile_tests
