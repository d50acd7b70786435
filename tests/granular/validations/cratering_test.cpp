// SPDX-License-Identifier: GPL-3.0-or-later
// Impact of a ball on a bed of grains.                                              Fang (2022), Sec. 7.2.3
#include "granular/validations/cratering.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::granular;

TEST_CASE(
    "a heavier ball makes a deeper crater in a settled bed, and the energy of its fall is consumed (long)",
    "[granular][cratering]")
{
    const double R = 4e-3, D = 0.0254, mu = 0.3, height = 0.1;
    const SettledBed bed = settled_bed(R, {});
    CHECK(bed.surface == Approx(0.11).margin(0.01));
    CHECK(bed.density / 2500 == Approx(0.56).margin(0.04));  // packing fraction with the layers at the walls
    double last = 0;
    for (const double density : {2200., 8000.}) {
        const Crater c = impact({R, density, height}, bed, {});
        CHECK(c.depth > 1.1 * last);
        last = c.depth;
        const double scale =
            std::sqrt(density / bed.density) * std::pow(D, 2. / 3) * std::cbrt(height + c.depth);
        CHECK(c.depth * mu / scale > 0.03);
        CHECK(c.depth * mu / scale < 0.14);
        // The ball hits the grains with the speed of the fall; it is fastest there or soon after.
        CHECK(c.motion.front().speed == Approx(std::sqrt(2 * 9.81 * height)).epsilon(0.06));
        CHECK(c.motion.back().speed < 0.01);
    }
    // The same bytes give the same impact.
    const Impact again{R, 2200, height};
    CHECK(impact(again, bed, {}).motion == impact(again, bed, {}).motion);
}
