// SPDX-License-Identifier: GPL-3.0-or-later
// Impact of a sphere on a bed of beads at low velocity.                          Fang (2022), Sec. 7.2.4
#include "granular/validations/low_velocity_cratering.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace hilda::granular;

TEST_CASE("the energy and the momentum of a sphere that hits a bed of beads balance (long)",
          "[granular][low-velocity]")
{
    // A small bed, in which the sphere has half of the radius of the cylinder
    const BeadCylinder cylinder{.radius = 0.1, .depth = 0.06, .h = 2e-5};
    const std::vector<Vec3> beads = settled_beads(cylinder, {});
    double top = 0;
    for (const Vec3& r : beads) {
        CHECK(std::hypot(r.x, r.y) < cylinder.radius - 4.9e-3);
        CHECK(r.z > 4.9e-3);
        top = std::max(top, r.z);
    }
    CHECK(top < 0.09);

    double last_depth = 0;
    for (const double speed : {0.2, 0.5}) {
        INFO(speed << " m/s");
        const SlowImpact of{.cylinder = cylinder, .height = 0.05, .speed = speed, .h = 2e-5};
        const CollisionRecord r = impact(of, beads, {});
        const Collision c = collision(r);
        CHECK(c.slowed);
        CHECK(c.speed == Approx(speed).epsilon(0.02));
        CHECK(c.start == Approx(50).margin(4));  // 5 ms of free fall
        CHECK(c.depth > last_depth);
        last_depth = c.depth;
        CHECK(r.a.front() == -of.g);
        CHECK(*std::max_element(r.a_low.begin(), r.a_low.end()) < *std::max_element(r.a.begin(), r.a.end()));

        // The acceleration is that of the contact forces and of gravity: its integral is the change of the
        // velocity, and that of the power of the contact forces the change of the energy.
        double momentum = 0, work = 0;
        for (std::size_t k = 1; k < r.a.size(); ++k) {
            momentum += r.interval / 2 * (r.a[k - 1] + r.a[k]);
            work += r.interval / 2 * ((r.a[k - 1] + of.g) * r.v[k - 1] + (r.a[k] + of.g) * r.v[k]);
        }
        const double v = r.v.front(), energy = v * v / 2 + of.g * (r.z.front() - r.z.back());
        CHECK(momentum == Approx(r.v.back() - v).epsilon(0.01));
        CHECK(-work == Approx(energy - r.v.back() * r.v.back() / 2).epsilon(0.01));
    }
    // The same beads give the same impact.
    const SlowImpact again{.cylinder = cylinder, .height = 0.05, .speed = 0.2, .h = 2e-5};
    CHECK(impact(again, beads, {}).z == impact(again, beads, {}).z);
    // Other beds have other names.
    BeadCylinder other = cylinder;
    other.depth = 0.07;
    CHECK(bed_case(other).hash() != bed_case(cylinder).hash());
}
