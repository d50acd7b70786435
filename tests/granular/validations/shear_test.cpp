// SPDX-License-Identifier: GPL-3.0-or-later
// Direct shear of a sample of grains.                                               Fang (2022), Sec. 7.2.2
#include "granular/validations/shear.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::granular;

TEST_CASE("the loads of a sheared sample balance its weight, and the shear stress grows with the load (long)",
          "[granular][shear]")
{
    // 240 grains
    ShearTest test{.box = {.edge = 0.06, .R = 5e-3, .h = 4e-5},
                   .stress = 5e3,
                   .speed = 0.02,
                   .distance = 3e-3,
                   .pressing = 0.2,
                   .interval = 1e-4,
                   .between_loads = 5};
    const std::string sample = settled_sample(test.box, {});
    const ShearRecord r = shear(test, sample, {});
    REQUIRE(r.x.size() == 30);
    CHECK(r.x.front() == Approx(5e-5));
    CHECK(r.x.back() == Approx(2.95e-3));
    CHECK(r.mean(r.support, 0, test.distance) == Approx(1).margin(0.02));
    CHECK(r.mean(r.lid_load, 0, test.distance) == Approx(1).margin(0.02));
    // σ is the stress of the lid and of about 3 cm of grains.
    CHECK(r.sigma - test.stress > 2550 * 9.81 * 0.55 * 0.02);
    CHECK(r.sigma - test.stress < 2550 * 9.81 * 0.65 * 0.04);
    CHECK(r.peak().tau > r.mean(r.tau, 0, test.distance));
    CHECK(r.peak().tau / r.sigma > 0.3);
    CHECK(r.peak().tau / r.sigma < 1.2);

    test.stress *= 2;
    const ShearRecord pressed = shear(test, sample, {});
    CHECK(pressed.peak().tau > 1.5 * r.peak().tau);
    CHECK(pressed.sigma - test.stress == Approx(r.sigma - test.stress / 2).epsilon(0.1));
    // The same sample gives the same record.
    CHECK(shear(test, sample, {}).tau == pressed.tau);

    ShearBox other = test.box;
    other.mu = 0.3;
    CHECK(bed_case(other).hash() != bed_case(test.box).hash());
}

TEST_CASE("the mean and the peak of a record of a shear test", "[granular][shear]")
{
    ShearRecord r;
    for (int k = 0; k < 10; ++k) r.x.push_back(1e-4 * (k + 0.5)), r.tau.push_back(k == 6 ? 8 : 1);
    CHECK(r.mean(r.tau, 0, 1e-3) == Approx(1.7));
    CHECK(r.mean(r.tau, 0, 5e-4) == 1);
    const ShearRecord::Peak peak = r.peak(2e-4);
    CHECK(peak.tau == Approx(4.5));
    CHECK(peak.x == Approx(6e-4));
    r.tau[2] = std::nan("");  // the peak of the other windows is not that of a failed test
    CHECK(std::isnan(r.peak(2e-4).tau));
}
