// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/scene.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;

TEST_CASE("a step of bodies in contact does not allocate memory", "[contact][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted: a sanitizer replaces malloc");
        return;
    }
    REQUIRE(tests::allocations_during([] { std::make_shared<Hertz>(1e6); }) > 0);
    const bool dissertation = GENERATE(true, false);
    FrictionParameters p{.mu_s = 0.25, .mu_k = 0.2, .K_E = 1e5, .eta_r = 0.2, .eta_psi = 0.01, .mu_r = 0.1};
    if (dissertation) p = p.as_in_dissertation();
    for (const FrictionLaw& law : io::Registry<FrictionLaw>::all()) {
        Scene scene;
        const Shape ball{std::make_shared<Sphere>(0.15)}, floor{std::make_shared<Plane>()};
        const Inertia inertia{1, 0.4 * 0.15 * 0.15 * lie::Mat3::Identity()};
        const auto normal = std::make_shared<Hertz>(1e6, 0.4);
        const auto friction = law.make(p);
        Motion low, high;
        low.r = {0, 0, 0.1495};
        low.rdot = {0.5, 0.1, 0};
        low.omega_bar = {0.3, 0, 2};
        high.r = {0.02, 0.01, 0.46};  // falls onto the lower ball and rolls off
        scene.add(inertia, low);
        scene.add(inertia, high);
        scene.add(Inertia{}, Motion{});
        scene.add("pair", 0, ball, 1, ball, normal, friction);
        scene.add("low", 0, ball, 2, floor, normal, friction);
        scene.add("high", 1, ball, 2, floor, normal, friction);
        bool touched = false;
        const long taken = tests::allocations_during([&] {
            for (int n = 0; n < 2000; ++n) {
                scene.step(1e-4);
                touched = touched || scene.pair[0].history.touching;
            }
        });
        INFO(law.name);
        CHECK(touched);
        CHECK(scene.pair[1].history.touching);
        CHECK(taken == 0);
    }
}
