// SPDX-License-Identifier: GPL-3.0-or-later
// What must not change the motion of rigid bodies: names of bodies, their order, the unit of length, a break.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

// Three boxes of different sizes and masses that fall on a floor and on each other, with lengths in units of
// `size` and times in units of √size
struct Boxes {
    double size = 1;
    bool exchanged = false;  ///< bodies i and j of their contacts
    bool reversed = false;   ///< the order of bodies and contacts in the file

    std::string text() const
    {
        const Vec3 lengths[] = {size * Vec3(0.5, 0.3, 0.2), size * Vec3(0.3, 0.2, 0.1),
                                size * Vec3(0.2, 0.2, 0.3)};
        const double mass[] = {3, 1, 0.5}, angle[] = {0.2, -0.3, 0.5};
        std::vector<std::string> bodies, contacts;
        for (int k = 0; k < 3; ++k) {
            bodies.push_back(body(name(k), mass[k] * size * size * size, box_shape(lengths[k]),
                                  size * Vec3(0.05 * k, 0.02 * k, 0.2 + 0.35 * k),
                                  std::sqrt(size) * Vec3(0.3, 0, -0.5),
                                  1 / std::sqrt(size) * Vec3(0.5, k, 0.3), about_y(angle[k])));
            contacts.push_back(on_floor(name(k), box_surface(lengths[k]), 0.4));
            for (int l = 0; l < k; ++l) {
                const int i = exchanged ? l : k, j = exchanged ? k : l;
                contacts.push_back(
                    contact_of(name(i), name(j), box_surface(lengths[i]), box_surface(lengths[j]), 0.3));
            }
        }
        if (reversed) {
            std::reverse(bodies.begin(), bodies.end());
            std::reverse(contacts.begin(), contacts.end());
        }
        return model(joined(bodies), joined(contacts));
    }
    double h() const { return 1e-3 * std::sqrt(size); }

    static std::string name(int k) { return "b" + std::to_string(k); }
};

double difference(const State& x, const State& y, bool reversed = false)
{
    double largest = 0;
    for (std::size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion &p = x.body[b], &q = y.body[reversed ? x.body.size() - 1 - b : b];
        largest = std::max({largest, (p.r - q.r).norm(), (p.rdot - q.rdot).norm(), (p.A - q.A).norm(),
                            (p.omega_bar - q.omega_bar).norm()});
    }
    return largest;
}

}  // namespace

TEST_CASE("bodies i and j of a rigid contact can be exchanged (long)", "[contact][rigid]")
{
    Run r(Boxes{}.text(), 1e-3), exchanged(Boxes{.exchanged = true}.text(), 1e-3);
    for (const double t : {0.1, 0.2, 0.3, 0.5, 1.}) {
        r.to(t), exchanged.to(t);
        CAPTURE(t);
        CHECK(difference(r.state(), exchanged.state()) == 0);
    }
}

TEST_CASE("the order of bodies and rigid contacts in a file changes rounding errors only", "[contact][rigid]")
{
    Run r(Boxes{}.text(), 1e-3), reversed(Boxes{.reversed = true}.text(), 1e-3);
    for (const double t : {0.1, 0.2, 0.3}) {
        r.to(t), reversed.to(t);
        CAPTURE(t);
        CHECK(difference(r.state(), reversed.state(), true) < 1e-7);
    }
}

TEST_CASE("a run with rigid contacts continues from a copied state with the same digits (long)",
          "[contact][rigid]")
{
    const std::string text = Boxes{}.text();
    for (const double at : {0.05, 0.25, 0.6}) {
        Run r(text, 1e-3);
        r.to(at);
        dae::Description d = dae::read_model(text, "m.json");
        dae::start(d);
        const auto integrator = lie::scheme("rA-moreau-1").make(*d.model, {});
        const long n = std::lround(at / 1e-3);
        if (n > 0) {
            lie::March march(r.state(), *integrator, 1e-3, n);
            for (int k = 0; k < 300; ++k) march.advance({});
            r.to(at + 0.3);
            CHECK(march.node().t == r.state().t);
            CHECK(difference(march.node(), r.state()) == 0);
            REQUIRE(march.node().cone_forces.size() == r.state().cone_forces.size());
            for (std::size_t k = 0; k < r.state().cone_forces.size(); ++k)
                CHECK(march.node().cone_forces[k].F == r.state().cone_forces[k].F);
        }
    }
}

TEST_CASE("rigid contacts do not depend on the unit of length (long)", "[contact][rigid]")
{
    Run r(Boxes{}.text(), 1e-3);
    for (const double size : {1e-3, 100.}) {
        const Boxes boxes{.size = size};
        Run scaled(boxes.text(), boxes.h());
        Run same(Boxes{}.text(), 1e-3);
        for (int n = 0; n < 250; ++n) scaled.step(), same.step();
        for (int k = 0; k < 3; ++k) {
            CAPTURE(size, k);
            CHECK((scaled.body(k).r / size - same.body(k).r).norm() < 1e-6);
        }
        scaled.to(scaled.state().t + 3 * std::sqrt(size));
        for (int k = 0; k < 3; ++k) CHECK(scaled.body(k).rdot.norm() < 1e-9 * std::sqrt(size));
    }
}

TEST_CASE("a box that carries 10000 times its mass stands and carries the weight", "[contact][rigid]")
{
    const Vec3 lengths(0.2, 0.2, 0.1);
    const std::string surface = box_surface(lengths);
    Run r(model(body("light", 1e-2, box_shape(lengths), Vec3(0, 0, 0.05)) + ", " +
                    body("heavy", 100, box_shape(lengths), Vec3(0.05, 0.02, 0.15)),
                on_floor("light", surface, 0.5) + ", " + contact_of("heavy", "light", surface, surface, 0.5)),
          1e-3);
    r.to(2);
    for (const int k : {0, 1}) {
        CHECK(r.body(k).rdot.norm() < 1e-10);
        CHECK(r.body(k).omega_bar.norm() < 1e-9);
    }
    CHECK((r.body(0).r - Vec3(0, 0, 0.05)).norm() < 1e-9);
    CHECK((r.body(1).r - Vec3(0.05, 0.02, 0.15)).norm() < 1e-9);
    double N[2] = {};
    for (const int k : {0, 1})
        for (const contact::LoadedPoint& p : r.points(k)) N[k] += p.N;
    CHECK(N[0] == Approx(100.01 * g).epsilon(1e-7));
    CHECK(N[1] == Approx(100 * g).epsilon(1e-7));
    CHECK(r.statistics().friction_relaxed == 0);
}

TEST_CASE("boxes at rest on a slope and on each other do not creep in 10 s (long)", "[contact][rigid]")
{
    const Vec3 lower(0.4, 0.3, 0.1), upper(0.15, 0.2, 0.2);
    const Vec3 gravity = g * Vec3(std::sin(20 * degree), 0, -std::cos(20 * degree));
    Run r(model(body("lower", 2, box_shape(lower), Vec3(0, 0, 0.05)) + ", " +
                    body("upper", 1, box_shape(upper), Vec3(0.1, 0.03, 0.2), Vec3::Zero(), Vec3::Zero(),
                         R"(, "axis_angle": [0, 0, 1, 0.3])"),
                on_floor("lower", box_surface(lower), 0.5) + ", " +
                    contact_of("upper", "lower", box_surface(upper), box_surface(lower), 0.4),
                gravity),
          1e-3);
    const State start = r.state();
    r.to(10);
    CHECK(difference(r.state(), start) < 1e-10);
}

}  // namespace rigid_tests
