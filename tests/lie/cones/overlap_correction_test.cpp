// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/overlap_correction.hpp"
#include "tests/lie/cones/contact_system.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

TEST_CASE("overlapping spheres move apart in the ratio of their masses", "[lie][cones]")
{
    tests::ContactSystem system;
    system.add_sphere(1, 0.1, {0, 0, 0});
    system.add_sphere(3, 0.1, {0.196, 0, 0});
    system.spheres.push_back({1, 0, 0.1, 0.1, 0.5, 0});
    lie::State x = system.start();
    lie::OverlapCorrection overlaps(system, 1e-10);
    REQUIRE(overlaps.correct(x, 1e-3));
    CHECK(x.body[0].r.x() == Approx(-0.003).epsilon(1e-7));
    CHECK(x.body[1].r.x() == Approx(0.197).epsilon(1e-9));
    CHECK(x.body[0].rdot == Vec3::Zero());
}

TEST_CASE("the correction of an overlap keeps joints closed and neighbours apart", "[lie][cones]")
{
    // a box on a ball joint, whose corners are below the ground, and a free box on it
    tests::ContactSystem system;
    const Vec3 half(0.1, 0.1, 0.05);
    system.add_box(1, half, {0, 0, 0.0499}, lie::exp(Vec3(0, 0.01, 0)));
    system.add_box(1, half, {0, 0, 0.1509});
    system.put_on(0, half, -1, 0, 0.5);
    system.put_on(1, half, 0, 0.05, 0.5);
    const Vec3 s_bar(-0.1, 0, 0.05);
    for (int k = 0; k < 3; ++k) system.pins.push_back({0, -1, s_bar, Vec3::Zero(), Vec3::Unit(k)});
    lie::State x = system.start();
    const Vec3 pin = tests::ContactSystem::point(x, 0, s_bar);
    for (auto& of : system.pins) of.s_bar_j = pin;
    lie::OverlapCorrection overlaps(system, 1e-10);
    lie::ConeRows found;
    system.cones(x, 0, found);
    REQUIRE(!found.cone.empty());
    REQUIRE(overlaps.correct(x, 1e-3));
    system.cones(x, 0, found);
    for (const auto& cone : found.cone) CHECK(cone.gap > -1e-9 * cone.size);
    CHECK((tests::ContactSystem::point(x, 0, s_bar) - pin).norm() < 1e-10);
}
