// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes for the comparison of contact methods: rigid and compliant contacts agree with each other and with
// closed forms.
#include "studies/experiments/chapter8/model_scene.hpp"

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

/// Total contact force on a fixed body [N]
Vec3 load_on(const contact::Scene& scene, int body)
{
    Vec3 F = Vec3::Zero();
    for (const auto& p : scene.neighbors.pair())
        if (p.j == body && p.state.contact_state.N > 0)
            F -= p.state.contact_state.N * p.state.contact_state.contact_point.n + p.state.wrench.F;
    return F;
}

}  // namespace

TEST_CASE("a chain starts with all contacts closed and a pile starts without contacts", "[studies][scenes]")
{
    RollingChain chain{.balls = 5};
    CHECK(contact_pairs(scene(chain), 1e-12).size() == 15);  // 10 walls, 4 balls, 1 push
    chain.speed = 0;
    CHECK(contact_pairs(scene(chain), 1e-12).size() == 14);

    const int balls = GENERATE(1, 30, 1000);
    const ContactScene pile = scene(Pile{.balls = balls});
    CHECK(pile.body.size() == static_cast<size_t>(balls) + 1);
    CHECK(contact_pairs(pile, 0).empty());
    if (balls > 1) CHECK(contact_pairs(pile, 0.2 * pile.R).size() > static_cast<size_t>(balls));
}

TEST_CASE("all balls of a chain roll down a groove with the acceleration of a single ball",
          "[studies][scenes]")
{
    const RollingChain chain{.balls = 4, .slope = 0.3, .speed = 0};
    const double a = 9.81 * std::sin(0.3) / (1 + 0.4 * chain.R * chain.R / (chain.rho() * chain.rho()));
    const double t = 0.2, distance = 0.5 * a * t * t, h = 2e-3;
    RigidScene rigid_scene(scene(chain));
    run(rigid_scene, h, t);
    auto compliant_scene = compliant(scene(chain), {});
    compliant_scene.check(5e-5);
    run(compliant_scene, 5e-5, t);
    for (int b = 0; b < 4; ++b) {
        // the scheme adds h times the velocity at the end of each step
        CHECK(rigid_scene.of.body(2 + b).r.x() - 0.2 * b == Approx(-distance * (1 + h / t)).epsilon(1e-6));
        CHECK(compliant_scene.body[2 + b].r.x() - 0.2 * b == Approx(-distance).epsilon(2e-3));
    }
}

TEST_CASE("the force on a pushed chain agrees with the closed form for any friction between the balls",
          "[studies][scenes]")
{
    const double mu = GENERATE(0., 0.2);
    const RollingChain chain{.balls = 4, .speed = 0.5, .mu_between = mu};
    const double c = mu / std::cos(RollingChain::wall), P_4 = 9.81 * std::sin(0.1) / (1 - c);
    REQUIRE(RollingChain{.balls = 1, .mu_between = mu}.push() == Approx(P_4));
    const int pusher = 6;
    RigidScene rigid_scene(scene(chain));
    run(rigid_scene, 2e-3, 0.06);
    CHECK(rigid_scene.load_on(pusher).x() == Approx(-chain.push()).epsilon(1e-4));
    auto compliant_scene = compliant(scene(chain), {});
    double mean = 0;  // the contact springs oscillate
    run(compliant_scene, 5e-5, 0.1);
    for (int n = 0; n < 1000; ++n) {
        compliant_scene.step(5e-5);
        mean -= load_on(compliant_scene, pusher).x() / 1000;
    }
    CHECK(mean == Approx(chain.push()).epsilon(1e-2));
}

TEST_CASE("a rigid and a compliant pile come to rest and the bowl supports their weight", "[studies][scenes]")
{
    const ContactScene pile = scene(Pile{.balls = 8});
    const double weight = 8 * 9.81;
    RigidScene rigid_scene(pile);
    run(rigid_scene, 5e-3, 4);
    CHECK(rigid_scene.of.kinetic_energy() < 1e-6);
    CHECK(rigid_scene.of.integrator->statistics().cone_residual < 1e-6);
    CHECK((rigid_scene.load_on(0) - Vec3(0, 0, -weight)).norm() < 1e-2 * weight);

    auto compliant_scene = compliant(pile, {.stiffness = 2e4});
    compliant_scene.check(4e-4);
    run(compliant_scene, 4e-4, 1.5);
    CHECK(compliant_scene.kinetic_energy() < 1e-6);
    CHECK((load_on(compliant_scene, 0) - Vec3(0, 0, -weight)).norm() < 1e-2 * weight);
    // The arrangements differ in detail. The centre of mass has the same height within a fifth of a radius.
    double height = 0;
    for (int b = 1; b <= 8; ++b) height += (compliant_scene.body[b].r - rigid_scene.of.body(b).r).z() / 8;
    CHECK(std::abs(height) < 0.2 * pile.R);
}

TEST_CASE("a scene without balls or with a negative radius is rejected", "[studies][scenes]")
{
    CHECK_THROWS_WITH(scene(Pile{.balls = 0}),
                      "studies::Pile: the number of balls must be at least 1, got 0");
    CHECK_THROWS_WITH(scene(RollingChain{.R = -1}),
                      "studies::RollingChain: a radius must be positive, got -1");
}
