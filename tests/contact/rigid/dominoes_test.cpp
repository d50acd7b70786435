// SPDX-License-Identifier: GPL-3.0-or-later
// A row of dominoes against the speed of its front for fixed lower edges and plastic collisions.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

// n dominoes of height H and thickness d with gaps s. The first one has almost fallen against the second one,
// with the angular velocity omega.
std::string dominoes(int n, double H, double d, double s, double omega)
{
    const Vec3 lengths(d, H / 2, H);
    const std::string surface = box_surface(lengths);
    std::vector<std::string> bodies, contacts;
    for (int k = 0; k < n; ++k) {
        const std::string name = "d" + std::to_string(k);
        const double angle = k == 0 ? 0.95 * std::asin(s / H) : 0;
        const double x = k * (d + s) + d / 2;  // of the edge about which it falls
        const Vec3 centre(x - d / 2 * std::cos(angle) + H / 2 * std::sin(angle), 0,
                          d / 2 * std::sin(angle) + H / 2 * std::cos(angle));
        const Vec3 arm = centre - Vec3(x, 0, 0), w(0, k == 0 ? omega : 0, 0);
        bodies.push_back(body(name, 0.01, box_shape(lengths), centre, w.cross(arm), w, about_y(angle)));
        contacts.push_back(on_floor(name, surface, 5));
        if (k > 0) contacts.push_back(contact_of(name, "d" + std::to_string(k - 1), surface, surface, 0));
    }
    return model(joined(bodies), joined(contacts));
}

/// Mean speed of the front over the last four of n dominoes that it reaches [m/s]
double front_speed(int n, double H, double d, double s, double omega, double h)
{
    Run r(dominoes(n, H, d, s, omega), h);
    const double angle = std::asin(s / H);  // of a collision
    double before = 0, first = 0;
    for (int k = n - 6;;) {
        r.step();
        const double now = r.angle_about_y(k), t = r.state().t - h * (now - angle) / (now - before);
        before = now;
        if (now < angle) continue;
        if (k == n - 6) first = t;
        if (k == n - 2) {
            CHECK(r.statistics().friction_relaxed == 0);
            return 4 * (d + s) / (t - first);
        }
        before = r.angle_about_y(++k);
    }
}

}  // namespace

TEST_CASE("the front of falling dominoes has the speed of the energy balance (long)", "[contact][rigid]")
{
    CHECK(front_speed(36, 0.048, 0.0075, 0.0085, 20, 4e-4) == Approx(1.380784398).epsilon(0.01));
}

TEST_CASE("the front of large dominoes has the speed of the energy balance (long)", "[contact][rigid]")
{
    CHECK(front_speed(24, 1, 0.179, 0.4, 4.5, 1e-3) == Approx(5.456195509).epsilon(0.01));
}

}  // namespace rigid_tests
