// SPDX-License-Identifier: GPL-3.0-or-later
// Wheel with prescribed slip on a bed of grains.                                    Fang (2022), Sec. 7.2.6
#include "granular/validations/wheel.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace hilda::granular;

TEST_CASE("the bed carries the weight of a wheel, and a larger slip gives more pull and torque (long)",
          "[granular][wheel]")
{
    const WheelBed bed{.length = 0.4, .width = 0.07, .depth = 0.05, .R = 1e-2, .h = 1e-4};
    const std::vector<Vec3> soil = settled_soil(bed, {});
    CHECK(soil.size() > 100);
    for (const Vec3& r : soil) {
        CHECK(r.z > 0.9 * bed.R);
        CHECK(r.z < 0.1);
    }
    WheelTest test{.bed = bed, .slip = -0.5, .duration = 1.5};
    const WheelRecord braked = drive(test, soil, {});
    test.slip = 0.7;
    const WheelRecord driven = drive(test, soil, {});
    const double from = 0.75;
    for (const WheelRecord* r : {&braked, &driven}) {
        CHECK(r->t.size() == 30);
        CHECK(r->mean(r->load, from).value == Approx(80).epsilon(0.05));
        CHECK(r->power > 0);
        CHECK(r->dissipated > 0);
    }
    CHECK(driven.mean(driven.pull, from).value > braked.mean(braked.pull, from).value);
    CHECK(driven.mean(driven.torque, from).value > braked.mean(braked.torque, from).value);
    for (const WheelRecord* r : {&braked, &driven}) CHECK(r->from == Approx(from));
    // The dissipation of the whole duration is that of both halves. A window that begins within an interval
    // begins with the next one.
    WheelTest part = test;
    part.averaged = 1;
    const WheelRecord whole = drive(part, soil, {});
    CHECK(whole.from == 0);
    part.duration = 0.75;
    const WheelRecord half = drive(part, soil, {});
    CHECK(2 * whole.dissipated == Approx(half.dissipated + driven.dissipated));
    part.averaged = 0.41;
    CHECK(drive(part, soil, {}).from == Approx(0.45));
    // v = ω radius (1 - slip)
    const double rim = 17 * M_PI / 180 * 0.13;
    CHECK(braked.wheel_x == Approx(0.18 + 1.5 * rim * 1.5).epsilon(1e-6));
    CHECK(driven.wheel_x == Approx(0.18 + 0.3 * rim * 1.5).epsilon(1e-6));
    CHECK(drive(test, soil, {}).pull == driven.pull);

    // A prism of many triangles is the cylinder, but for the scatter of a small bed.
    test.shape = WheelShape::prism;
    const WheelRecord prism = drive(test, soil, {});
    CHECK(prism.mean(prism.torque, from).value ==
          Approx(driven.mean(driven.torque, from).value).epsilon(0.3));
    CHECK(prism.mean(prism.load, from).value == Approx(80).epsilon(0.05));
    // Wheels that are narrower than the period
    test.bed.width = 0.2, test.duration = 1;
    const std::vector<Vec3> wide = settled_soil(test.bed, {});
    for (const WheelShape shape : {WheelShape::closed_cylinder, WheelShape::tyre}) {
        test.shape = shape;
        const WheelRecord narrow = drive(test, wide, {});
        CHECK(narrow.mean(narrow.load, 0.5).value == Approx(80).epsilon(0.05));
        CHECK(narrow.mean(narrow.torque, 0.5).value > 0);
    }
    test.bed.width = 0.07;

    WheelBed other = bed;
    other.settling_mu = 0.5;
    CHECK(bed_case(other).hash() != bed_case(bed).hash());
}

TEST_CASE("the mean of a record of a wheel test", "[granular][wheel]")
{
    WheelRecord r;
    r.t = {1, 2, 3, 4};
    const std::vector<double> column = {9, 9, 1, 3};
    CHECK(r.mean(column, 2.5).value == 2);
    CHECK(r.mean(column, 2.5).deviation == Approx(1));
}
