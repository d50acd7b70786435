// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces with internal states, the check of a force at a start, and its stability limit.

#include "dae/forces/torsion_spring.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/bristle.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using tests::Bristle;

namespace {

struct TwoBodies {
    Model model;
    State x;

    TwoBodies()
    {
        for (const char* name : {"a", "b"})
            model.add({.name = name, .m = 2, .J_bar = Vec3(1, 1.2, 1.4).asDiagonal()});
        x.body.resize(2);
        x.body[0].r = {1, 0, 0};
        x.body[1].r = {0, 2, 0};
    }
    const Bristle& bristle(int k) const { return dynamic_cast<const Bristle&>(*model.forces()[k]); }
};

}  // namespace

TEST_CASE("each force has its own internal states, stored in the state only", "[dae][remembered]")
{
    TwoBodies two;
    Model& model = two.model;
    State& x = two.x;
    model.gravity.setZero();
    model.load(TorsionSpring(ground, Z, 0, Z, 0, 0, 0, x));
    model.load(Bristle(ground, 0, 3, 0.5));
    model.load(TorsionSpring(0, Z, 1, Z, 0, 0, 0, x));
    model.load(Bristle(0, 1, 5, 0.25));
    x.internal_state = {7, 7};  // left from another model
    model.prepare(x);
    CHECK(x.discrete_state == std::vector<int>{0, 0});
    CHECK(x.internal_state == std::vector<double>{1, 1, 0, 0, 1, -1, 2, 0});

    const auto loads = [&](const State& at) {
        lie::Loads out(2);
        model.loads(at, out);
        return out;
    };
    State after = x;
    after.body[0].r.x() = 1.25;
    after.body[1].r = {0.25, 3, 0};
    after.body[0].A = lie::exp(1.5 * Z);
    const lie::Loads before_accepted = loads(after);
    CHECK(before_accepted.F[1].isApprox(Vec3(0, -5, 0)));  // elastic displacement 1 m
    model.accepted(x, after);
    CHECK(after.discrete_state == std::vector<int>{1, -1});
    CHECK(after.internal_state == std::vector<double>{1, 1, 0, 0, 1, -1, 2.75, 0});  // the second has slipped
    CHECK(loads(after).F[1].isApprox(Vec3(0, -1.25, 0)));
    CHECK(loads(after).F[0].isApprox(Vec3(-0.75, 1.25, 0)));
    CHECK(x.internal_state == std::vector<double>{1, 1, 0, 0, 1, -1, 2, 0});

    model.prepare(after);  // a new start
    CHECK(after.internal_state == std::vector<double>{1, 1.25, 0, 0, 1, -1, 3, 0});
    CHECK(loads(after).F[0].norm() == 0);
}

TEST_CASE("internal states at a start belong to the projected positions", "[dae][remembered]")
{
    TwoBodies two;
    two.model.constrain("pin", revolute(ground, O, X, 0, Vec3(-0.9, 0, 0), X));
    two.model.load(Bristle(ground, 0, 3, 0.01));
    start(two.model, two.x, {.fix_initial = true});
    CHECK(std::abs(two.x.body[0].r.x() - 0.9) < 1e-12);
    CHECK(two.bristle(0).relaxed(two.x) == two.x.body[0].r);
}

// A bristle that does not slip is a spring. A slipping bristle exerts a constant force, here 1 N beyond 0.1
// m.
TEST_CASE("forces with internal states reproduce the closed-form motion", "[dae][remembered]")
{
    for (const lie::Scheme& scheme : lie::schemes()) {
        TwoBodies two;
        two.model.gravity = {0, 0, 0};
        two.model.load(Bristle(ground, 0, 8, 10));
        two.model.load(Bristle(ground, 1, 10, 0.1));
        two.x.body[0].rdot = two.x.body[1].rdot = {1, 0, 0};
        start(two.model, two.x);
        const auto integrator = scheme.make(two.model, {});
        constexpr double h = 1e-3, t = 0.5;
        lie::March march(two.x, *integrator, h);
        INFO(scheme.name);
        if (!scheme.supports.contains(lie::Feature::history)) {
            REQUIRE_THROWS_WITH(march.advance({}), Catch::Contains("loads with a history"));
            continue;
        }
        for (int n = 0; n < 500; ++n) march.advance({});
        CHECK(march.node().body[0].r.x() - 1 == Approx(std::sin(2 * t) / 2).margin(2e-3));
        const double omega = std::sqrt(10 / 2.0), t_1 = std::asin(0.1 * omega) / omega, s = t - t_1;
        const double slipped = 0.1 + std::cos(omega * t_1) * s - 0.25 * s * s;
        CHECK(march.node().body[1].r.x() == Approx(slipped).margin(2e-3));
    }
}

TEST_CASE("a force that cannot be used from a start is named before internal states are set",
          "[dae][remembered]")
{
    TwoBodies two;
    two.model.load(TorsionSpring(ground, Z, 0, Z, 0, 0, 0, two.x));
    Bristle bristle(0, 1, 3, 0.5);
    bristle.name = "velvet";
    two.model.load(std::move(bristle));
    two.x.body[1].r = two.x.body[0].r;
    try {
        start(two.model, two.x);
        FAIL("a bristle between bodies at one place was accepted");
    } catch (const ForceError& e) {
        CHECK(e.force == 1);
        CHECK_THAT(e.what(), Catch::Equals("bristle 'velvet': the bodies must be apart at the start"));
    }
    CHECK(two.x.discrete_state.empty());
    CHECK(two.x.internal_state.empty());
}

TEST_CASE("the stable step of a model is the smallest stable step of its forces", "[dae][remembered]")
{
    TwoBodies two;
    CHECK(two.model.stable_step(two.x).force == -1);
    two.model.load(TorsionSpring(ground, Z, 0, Z, 1, 0, 0, two.x));
    CHECK(two.model.stable_step(two.x).h == std::numeric_limits<double>::infinity());
    CHECK(two.model.stable_step(two.x).force == -1);
    two.model.load(Bristle(ground, 0, 1, 1));
    two.model.load(Bristle(ground, 1, 16, 1));
    two.model.load(Bristle(0, 1, 4, 1));
    CHECK(two.model.stable_step(two.x).h == 0.5);
    CHECK(two.model.stable_step(two.x).force == 2);
}
