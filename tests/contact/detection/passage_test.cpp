// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that pass through each other within a step.
#include "contact/detection/passage.hpp"

#include "contact/evolving/unilateral.hpp"
#include "dae/model_file.hpp"
#include "lie/schemes.hpp"
#include "tests/support/watched_march.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace hilda;
using Catch::Contains;
using lie::Motion;
using lie::Vec3;

namespace {

/// Two balls of radius 0.02 m, of which the first one moves with 300 m/s along x. `y`: offset of its path
std::string balls(double y, const std::string& normal, double distance = 0.5137)
{
    return fmt::format(
        R"({{"hilda_model": 1, "name": "balls", "gravity": [0, 0, 0], "bodies": [)"
        R"({{"name": "a", "mass": 1, "inertia": [1.6e-4, 1.6e-4, 1.6e-4], "r": [0, {}, 0], "r_dot": [300, 0, 0]}}, )"
        R"({{"name": "b", "mass": 1, "inertia": [1.6e-4, 1.6e-4, 1.6e-4], "r": [{}, 0, 0]}}], )"
        R"("contacts": [{{"name": "c", "body_i": "a", "body_j": "b", )"
        R"("surface_i": {{"type": "sphere", "radius": 0.02}}, "surface_j": {{"type": "sphere", "radius": 0.02}}, )"
        R"("normal": {}}}]}})",
        y, distance, normal);
}

const std::string hertz = R"({"type": "hertz", "E_star": 1e7, "restitution": 0.8})",
                  rigid = R"({"type": "constraint", "unilateral": true, "restitution": 1})";

}  // namespace

TEST_CASE("a pass through a sphere is found where the straight path has it", "[contact][detection]")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int hits = 0;
    for (int k = 0; k < 200; ++k) {
        const double R = std::pow(10, 2 * uniform(random));
        Motion i_begin, j_begin;
        i_begin.A = j_begin.A = lie::Mat3::Identity();
        i_begin.r = R * 5 * Vec3(uniform(random), uniform(random), uniform(random));
        j_begin.r = i_begin.r + R * (4 + uniform(random)) * Vec3(1, 0.4 * uniform(random), 0).normalized();
        const double h = 1e-3;
        i_begin.rdot = R / h * Vec3(uniform(random), uniform(random), uniform(random));
        j_begin.rdot = i_begin.rdot - R / h * (8 + 3 * uniform(random)) * Vec3(1, 0.2 * uniform(random), 0);
        Motion i_end = i_begin, j_end = j_begin;
        i_end.r += h * i_begin.rdot, j_end.r += h * j_begin.rdot;
        const auto gap = [&](const Motion& i, const Motion& j) { return (i.r - j.r).norm() - 2 * R; };
        // closest approach on the straight path
        const Vec3 d = j_begin.r - i_begin.r, v = h * (j_begin.rdot - i_begin.rdot);
        const double nearest = (d - d.dot(v) / v.squaredNorm() * v).norm() - 2 * R;
        CAPTURE(k, R, nearest);
        if (std::abs(nearest) < 1e-5 * R || gap(i_end, j_end) < 0) continue;
        const contact::Passage passage(i_begin, i_end, j_begin, j_end, h, R, R);
        const double s = passage.first_overlap(gap(i_begin, j_begin), R, gap);
        CHECK((s < 1) == (nearest < 0));
        if (s < 1) {
            ++hits;
            const double first = (-d.dot(v) - std::sqrt(d.dot(v) * d.dot(v) -
                                                        v.squaredNorm() * (d.squaredNorm() - 4 * R * R))) /
                                 v.squaredNorm();
            CHECK(s == Approx(first).margin(3e-3 * R / passage.length()));
        }
    }
    CHECK(hits > 50);
}

TEST_CASE("a turning body passes through another one", "[contact][detection]")
{
    // The end of a rod of 1 m turns by 90 degrees through a small ball.
    Motion rod, ball;
    rod.A = ball.A = lie::Mat3::Identity();
    rod.omega_bar = {0, 0, M_PI / 2};
    Motion rod_end = rod;
    rod_end.A = lie::exp(Vec3(0, 0, M_PI / 2));
    ball.r = Vec3(std::cos(0.6), std::sin(0.6), 0);
    const auto gap = [](const Motion& i, const Motion& j) {
        return (i.A * Vec3::UnitX() - j.r).norm() - 0.05;
    };
    const contact::Passage passage(rod, rod_end, ball, ball, 1, 1, 0.05);
    CHECK(passage.length() == Approx(M_PI / 2));
    CHECK(passage.first_overlap(gap(rod, ball), 0.05, gap) == Approx((0.6 - 0.05) / (M_PI / 2)).margin(1e-3));
}

TEST_CASE("a step in which bodies with a compliant contact pass through each other is refused",
          "[contact][detection]")
{
    int missed = 0;
    for (int k = 0; k < 60; ++k) {
        const double h = 1e-3 / (1 + k % 4), y = 0.03 * (k % 3) / 2, distance = 0.5 + 0.01 * k;
        CAPTURE(k, h, y);
        const dae::Description d = [&] {
            dae::Description read = dae::read_model(balls(y, hertz, distance), "m.json");
            dae::start(read);
            return read;
        }();
        // A ball that has not been hit is at rest at the end.
        try {
            const lie::State x = tests::march(*d.model, d.x, "rA-half-1-kick", 5e-3, h);
            CHECK(x.body[1].rdot.norm() > 0.1);
        } catch (const lie::NumericalFailure& e) {
            CHECK(e.status == "contact_missed");
            CHECK_THAT(e.what(), Contains("contact 'c': the bodies pass through each other between t = ") &&
                                     Contains("use a step below "));
            ++missed;
        }
    }
    CHECK(missed > 20);
}

TEST_CASE("an impact of unilateral contacts is found within a long step", "[contact][detection][evolving]")
{
    for (int k = 0; k < 60; ++k) {
        const double y = 0.039 * (k % 6) / 5, h = 1e-3 / (1 + k % 3), distance = 0.3037 + 0.006 * k;
        CAPTURE(k, y, h);
        dae::Description d = dae::read_model(balls(y, rigid, distance), "m.json");
        dae::start(d);
        const auto integrator =
            contact::make_integrator(*d.model, lie::scheme("rA-half-1-kick"), {.tolerance = 1e-12});
        const lie::State x = lie::march(d.x, *integrator, lie::TimeGrid::over(3e-3, h, 3e-3), {}).row.back();
        // elastic impact of equal smooth balls: the velocity along the normal is exchanged
        const double sine = y / 0.04, cosine = std::sqrt(1 - sine * sine);
        CHECK(x.body[1].rdot.x() == Approx(300 * cosine * cosine).epsilon(1e-6));
        CHECK(x.body[1].rdot.y() == Approx(-300 * cosine * sine).margin(1e-3));
        CHECK(x.body[0].rdot.x() == Approx(300 * sine * sine).margin(1e-3));
    }
}
