// SPDX-License-Identifier: GPL-3.0-or-later
// Flow of grains in a rotating drum.                                                Fang (2022), Sec. 7.2.5
#include "granular/validations/drum.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace hilda::granular;

TEST_CASE(
    "the flow in a drum depends on the Froude number only, and a fast drum is covered all around (long)",
    "[granular][drum]")
{
    const Drum drum{.width = 6e-3, .R = 1.5e-3, .h = 2.4e-5};
    const std::vector<Vec3> grains = settled_grains(drum, {});
    CHECK(grains.size() > 200);
    for (const Vec3& r : grains) {
        CHECK(r.z < 0);
        CHECK(std::hypot(r.x, r.z) < drum.radius - 1.5 * drum.R);
    }
    const DrumRun slow{.drum = drum, .froude = 0.1, .turns = 0.5, .averaged = 0.25};
    const DrumFlow f = flow(slow, grains, {});
    CHECK(f.centres.size() == grains.size());
    CHECK(f.centre_angle > 15);
    CHECK(f.centre_angle < 75);
    CHECK(f.covered < 0.8);

    // E ~ g, h ~ 1/omega: powers of two change no rounding, so that the positions are equal.
    DrumRun heavy = slow;
    heavy.drum.g *= 4, heavy.drum.E *= 4, heavy.drum.h /= 2;
    CHECK(heavy.omega() == Approx(2 * slow.omega()).epsilon(1e-14));
    const DrumFlow same = flow(heavy, grains, {});
    double largest = 0;
    for (std::size_t k = 0; k < grains.size(); ++k)
        largest = std::max(largest, (same.centres[k] - f.centres[k]).norm());
    CHECK(largest < 1e-3 * drum.R);

    const DrumRun fast{.drum = drum, .froude = 4, .turns = 3, .averaged = 0.25};
    const DrumFlow rim = flow(fast, grains, {});
    CHECK(rim.covered == 1);
    CHECK(bed_case(heavy.drum).hash() != bed_case(drum).hash());
}

TEST_CASE("the angle of a plane surface", "[granular][drum]")
{
    std::vector<double> x, z;
    for (int k = -10; k <= 10; ++k) x.push_back(1e-3 * k), z.push_back(2e-3 - 0.5e-3 * k);
    CHECK(surface_angle(x, z, 0.01) == Approx(std::atan(0.5) * 180 / M_PI));
    z[10] = std::numeric_limits<double>::quiet_NaN();  // a column without surface
    z[0] = 1;                                          // outside the middle part
    CHECK(surface_angle(x, z, 0.01) == Approx(std::atan(0.5) * 180 / M_PI));
    CHECK(std::isnan(surface_angle({0}, {1}, 0.01)));
}
