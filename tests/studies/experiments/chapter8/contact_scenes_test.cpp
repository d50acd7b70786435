// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes on which contact methods are compared: rigid and compliant bodies agree on them, and with closed forms.
#include "studies/experiments/chapter8/contact_scenes.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::studies;
using lie::Vec3;

namespace {

template <class Scene>
void run(Scene& scene, double h, double end)
{
    for (int n = 0; n < std::lround(end / h); ++n) scene.step(h);
}

Vec3 force_on_i(const contact::DviScene::Encounter& e) { return e.F; }
Vec3 force_on_i(const contact::Scene::Encounter& e)
{
    return e.contact_state.N > 0 ? Vec3(e.contact_state.N * e.contact_state.contact_point.n + e.wrench.F)
                                 : Vec3(Vec3::Zero());
}

/// What a body that does not move carries [N]
template <class Scene>
Vec3 load_on(const Scene& scene, int body)
{
    Vec3 F = Vec3::Zero();
    for (const auto& p : scene.neighbors.pair())
        if (p.j == body) F -= force_on_i(p.state);
    return F;
}

}  // namespace

TEST_CASE("a chain touches its walls and its neighbours and a pile begins without a contact",
          "[studies][scenes]")
{
    RollingChain chain{.balls = 5};
    CHECK(touching(scene(chain), 1e-12).size() == 15);  // 10 on the walls, 4 between, 1 that pushes
    chain.speed = 0;
    CHECK(touching(scene(chain), 1e-12).size() == 14);

    const int balls = GENERATE(1, 30, 1000);
    const ContactScene pile = scene(Pile{.balls = balls});
    CHECK(pile.body.size() == static_cast<size_t>(balls) + 1);
    CHECK(touching(pile, 0).empty());
    if (balls > 1) CHECK(touching(pile, 0.2 * pile.R).size() > static_cast<size_t>(balls));
}

TEST_CASE("a chain that rolls down a groove goes as one ball would", "[studies][scenes]")
{
    const RollingChain chain{.balls = 4, .slope = 0.3, .speed = 0};
    const double a = 9.81 * std::sin(0.3) / (1 + 0.4 * chain.R * chain.R / (chain.rho() * chain.rho()));
    const double t = 0.2, way = 0.5 * a * t * t;
    auto hard = rigid(scene(chain));
    hard.solver.tolerance = 1e-11;
    run(hard, 2e-3, t);
    auto soft = compliant(scene(chain), {});
    soft.check(5e-5);
    run(soft, 5e-5, t);
    for (int b = 0; b < 4; ++b) {
        CHECK(hard.body[2 + b].r.x() - 0.2 * b == Approx(-way).epsilon(1e-6));
        CHECK(soft.body[2 + b].r.x() - 0.2 * b == Approx(-way).epsilon(2e-3));
    }
}

TEST_CASE("a chain that is pushed presses the harder the more its balls rub on each other",
          "[studies][scenes]")
{
    const double mu = GENERATE(0., 0.2);
    const RollingChain chain{.balls = 4, .speed = 0.5, .mu_between = mu};
    const double c = mu / std::cos(RollingChain::wall), P_4 = 9.81 * std::sin(0.1) / (1 - c);
    REQUIRE(RollingChain{.balls = 1, .mu_between = mu}.push() == Approx(P_4));
    const int pusher = 6;
    auto hard = rigid(scene(chain));
    hard.options.sliding = contact::DviOptions::coulomb;
    hard.solver.tolerance = 1e-8;
    run(hard, 2e-3, 0.06);
    CHECK(load_on(hard, pusher).x() == Approx(-chain.push()).epsilon(1e-4));
    auto soft = compliant(scene(chain), {});
    double mean = 0;  // the springs swing
    run(soft, 5e-5, 0.1);
    for (int n = 0; n < 1000; ++n) {
        soft.step(5e-5);
        mean -= load_on(soft, pusher).x() / 1000;
    }
    CHECK(mean == Approx(chain.push()).epsilon(1e-2));
}

TEST_CASE("a pile comes to rest and its bowl carries its weight whether rigid or compliant",
          "[studies][scenes]")
{
    const ContactScene pile = scene(Pile{.balls = 8});
    const double weight = 8 * 9.81;
    auto hard = rigid(pile);
    run(hard, 5e-3, 4);
    CHECK(hard.kinetic_energy() < 1e-6);
    CHECK(hard.solved.residual <= hard.solver.tolerance);
    CHECK((load_on(hard, 0) - Vec3(0, 0, -weight)).norm() < 1e-2 * weight);

    auto soft = compliant(pile, {.stiffness = 2e4});
    soft.check(4e-4);
    run(soft, 4e-4, 1.5);
    CHECK(soft.kinetic_energy() < 1e-6);
    CHECK((load_on(soft, 0) - Vec3(0, 0, -weight)).norm() < 1e-2 * weight);
    // The same heap, but for how each came to rest: the centre of mass is as high, against the way of a radius.
    double height = 0;
    for (int b = 1; b <= 8; ++b) height += (soft.body[b].r - hard.body[b].r).z() / 8;
    CHECK(std::abs(height) < 0.2 * pile.R);
}

TEST_CASE("a scene without balls is refused", "[studies][scenes]")
{
    CHECK_THROWS_WITH(scene(Pile{.balls = 0}), "studies::Pile: there must be a ball, got 0");
    CHECK_THROWS_WITH(scene(RollingChain{.R = -1}),
                      "studies::RollingChain: a radius must be positive, got -1");
}
