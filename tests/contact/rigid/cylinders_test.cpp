// SPDX-License-Identifier: GPL-3.0-or-later
// Solid cylinders, whose ends are disks: they come to rest on an end or a side, roll and spin.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

struct Cylinder {
    double R = 0.05, L = 0.1, mu = 0.5;

    std::string text(const Vec3& r, double tilt, const Vec3& v, const Vec3& omega,
                     const Vec3& gravity = Vec3(0, 0, -g)) const
    {
        const auto end = [&](const char* name, double z) {
            return R"({"name": ")" + std::string(name) + R"(", "body_i": "c", "body_j": "ground", )" +
                   R"("surface_i": {"type": "disk", "radius": )" + number(R) + R"(, "position": )" +
                   list(Vec3(0, 0, z)) + R"(}, "surface_j": {"type": "plane"}, )" + dvi(mu, 0) + '}';
        };
        return model(body("c", 1, R"({"cylinder": [)" + number(R) + ", " + number(L) + R"(], "axis": "z"})",
                          r, v, omega, R"(, "axis_angle": [1, 0, 0, )" + number(tilt) + ']'),
                     end("bottom", -L / 2) + ", " + end("top", L / 2), gravity);
    }
};

/// Steps until t. The energy must not rise, beside rounding errors.
double largest_rise(Run& r, double t)
{
    double rise = 0, before = r.energy();
    r.to(t, [&](const State&) {
        const double now = r.energy();
        rise = std::max(rise, now - before);
        before = now;
    });
    return rise;
}

}  // namespace

TEST_CASE("a cylinder that is dropped comes to rest on its end or on its side (long)", "[contact][rigid]")
{
    const Cylinder of;
    for (const double tilt : {0., 5., 20., 44., 46., 60., 85., 90.}) {
        CAPTURE(tilt);
        Run r(of.text(Vec3(0, 0, 0.2), tilt * degree, Vec3(0.2, 0.1, 0), Vec3(0.3, 1, 3)), 1e-3);
        CHECK(largest_rise(r, 5) < 1e-6);
        CHECK(r.statistics().overlap < 1e-6);
        CHECK(r.statistics().friction_relaxed == 0);
        const double upright = std::abs(r.body(0).A(2, 2));
        CHECK(std::min(upright, 1 - upright) < 1e-6);
        CHECK(std::abs(r.body(0).r.z() - 0.05) < 1e-6);
        if (upright > 0.5) CHECK(r.body(0).rdot.norm() + r.body(0).omega_bar.norm() < 1e-8);
        // on its side it rolls
        if (upright < 0.5)
            CHECK(std::abs(r.body(0).rdot.norm() - 0.05 * std::abs(r.body(0).omega_bar.z())) < 1e-6);
    }
}

TEST_CASE("a cylinder that stands on a slope does not move", "[contact][rigid]")
{
    Run r(Cylinder{}.text(Vec3(0, 0, 0.05), 0, Vec3::Zero(), Vec3::Zero(),
                          g * Vec3(std::sin(10 * degree), 0, -std::cos(10 * degree))),
          1e-3);
    double fastest = 0;
    r.to(2, [&](const State& x) {
        fastest = std::max(fastest, x.body[0].rdot.norm() + 0.05 * x.body[0].omega_bar.norm());
    });
    CHECK(fastest < 1e-10);
    double N = 0;
    for (const auto& p : r.points(0)) N += p.N;
    CHECK(N == Approx(g * std::cos(10 * degree)).epsilon(1e-6));
}

TEST_CASE("a cylinder on its side rolls without slip", "[contact][rigid]")
{
    Run r(Cylinder{}.text(Vec3(0, 0, 0.05), 90 * degree, Vec3(0.5, 0, 0), Vec3::Zero()), 1e-3);
    CHECK(largest_rise(r, 1) < 1e-12);
    CHECK(r.body(0).rdot.x() == Approx(0.5 * 2 / 3).epsilon(1e-9));  // angular momentum about the contact
    CHECK(r.body(0).rdot.x() == Approx(-0.05 * r.body(0).omega_bar.z()).epsilon(1e-9));
    CHECK(r.points(0).size() == 1);
    CHECK(r.points(1).size() == 1);
}

TEST_CASE("an Euler disk loses energy until it lies (long)", "[contact][rigid]")
{
    const Cylinder coin{.R = 0.05, .L = 0.004};
    const double tilt = 30 * degree;
    const Vec3 r_0(0, 0, 0.05 * std::sin(tilt) + 0.002 * std::cos(tilt));
    Run r(coin.text(r_0, tilt, Vec3::Zero(), 20 * Vec3(0, std::sin(tilt), 0.2 * std::cos(tilt))), 1e-3);
    CHECK(largest_rise(r, 2) < 1e-6);
    CHECK(r.statistics().overlap < 1e-6);
    CHECK(r.body(0).r.z() < r_0.z());

    Run spin(coin.text(Vec3(0, 0, 0.05), 90 * degree, Vec3::Zero(), Vec3(0, 40, 0)), 1e-3);
    CHECK(largest_rise(spin, 2) < 1e-6);
    CHECK(spin.statistics().overlap < 1e-6);
}

}  // namespace rigid_tests
