// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry of a bed of spheres.
#include "granular/validations/bed_geometry.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::granular;

TEST_CASE("a ball and a horizontal cylinder touch a bed from above", "[granular][beds]")
{
    const std::vector<BedSphere> bed = {{{0, 0, 1}, 0.5}, {{0.8, 0, 0.5}, 0.5}};
    const auto of_ball = [](double x, double y) {
        return [=](const Vec3& r) { return std::hypot(r.x - x, r.y - y); };
    };
    CHECK(first_contact(bed, 0.5, of_ball(0, 0)) == Approx(2));
    CHECK(first_contact(bed, 0.5, of_ball(0, 0.6)) == Approx(1.8));
    CHECK(first_contact(bed, 0.5, of_ball(1.8, 0)) == Approx(0.5));  // beside the bed, on the floor
    const double z = first_contact(bed, 0.5, of_ball(0.7, 0));
    CHECK((Vec3{0.7, 0, z} - bed[0].r).norm() == Approx(1));
    CHECK((Vec3{0.7, 0, z} - bed[1].r).norm() > 1);
    CHECK(first_contact(bed, 0.5, [](const Vec3& r) { return std::abs(r.x - 0.6); }) == Approx(1.8));
    CHECK(first_contact({}, 0.3, of_ball(0, 0)) == 0.3);
    CHECK(highest_point(bed) == 1.5);
}

TEST_CASE("the bulk density counts the parts of spheres between two planes", "[granular][beds]")
{
    const double R = 0.1, volume = 4 * M_PI / 3 * R * R * R;
    const auto density = [&](const std::vector<double>& heights) {
        std::vector<Vec3> centres;
        for (const double z : heights) centres.push_back({0, 0, z});
        return bulk_density(equal_spheres(centres, R), 2, 3, 2500);  // between 0.4 and 1.6
    };
    const double one = 2500 * volume / (3 * 1.2);
    CHECK(density({1}) == Approx(one));
    CHECK(density({0.4}) == Approx(one / 2));
    CHECK(density({1.6}) == Approx(one / 2));
    CHECK(density({0.35, 0.45}) == Approx(one));  // two parts of one sphere
    CHECK(density({0.2, 1.8}) == 0);
    CHECK(density({1, 1.2, 0.8, 1.9}) == Approx(3 * one));
}

TEST_CASE("98 % of the centres are below the height of a bed", "[granular][beds]")
{
    std::vector<Vec3> centres;
    for (int k = 99; k >= 0; --k) centres.push_back({0, 0, 0.01 * k});
    const double height = height_of_98_percent(equal_spheres(centres, 0.1));
    CHECK(std::count_if(centres.begin(), centres.end(), [&](const Vec3& r) { return r.z < height; }) == 98);
}
