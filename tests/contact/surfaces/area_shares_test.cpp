// SPDX-License-Identifier: GPL-3.0-or-later
// Shares of the corners of a polygon.
#include <catch2/catch.hpp>

#include "contact/surfaces/area_shares.hpp"
#include "contact/surfaces/polytope.hpp"
#include "tests/support/random_motion.hpp"

#include <numbers>

using namespace hilda;
using lie::Vec3;

namespace area_shares_tests {

namespace {

std::vector<double> shares(const std::vector<Vec3>& corner)
{
    std::vector<double> share;
    contact::area_shares(corner, share);
    return share;
}

/// A convex polygon with its corners on an ellipse, in a random plane
std::vector<Vec3> polygon(tests::Random& random, int corners)
{
    std::vector<double> angle;
    for (int k = 0; k < corners; ++k) angle.push_back(random.number(0, 2 * std::numbers::pi));
    std::sort(angle.begin(), angle.end());
    const lie::Mat3 A = random.rotation();
    const Vec3 at = random.vector(3);
    std::vector<Vec3> all;
    for (const double a : angle) all.push_back(at + A * Vec3(2 * std::cos(a), 0.7 * std::sin(a), 0));
    return all;
}

/// The centroid of a convex polygon, as the mean over many points of its area
Vec3 centroid(const std::vector<Vec3>& corner)
{
    Vec3 sum = Vec3::Zero();
    double area = 0;
    for (std::size_t k = 1; k + 1 < corner.size(); ++k) {
        const double part = (corner[k] - corner[0]).cross(corner[k + 1] - corner[0]).norm();
        sum += part * (corner[0] + corner[k] + corner[k + 1]) / 3;
        area += part;
    }
    return sum / area;
}

}  // namespace

TEST_CASE("the shares of corners are positive, with the sum 1 and the centroid of the area as their centre",
          "[contact][surfaces]")
{
    tests::Random random(5);
    for (int n = 0; n < 300; ++n) {
        const std::vector<Vec3> corner = polygon(random, 3 + n % 8);
        const std::vector<double> share = shares(corner);
        double sum = 0;
        Vec3 centre = Vec3::Zero();
        for (std::size_t k = 0; k < corner.size(); ++k) {
            CHECK(share[k] > 0);
            sum += share[k], centre += share[k] * corner[k];
        }
        CHECK(sum == Approx(1).epsilon(1e-13));
        CHECK((centre - centroid(corner)).norm() < 1e-12);
    }
}

TEST_CASE("corners at one place have the share of one", "[contact][surfaces]")
{
    tests::Random random(6);
    for (int n = 0; n < 50; ++n) {
        std::vector<Vec3> corner = polygon(random, 5);
        const std::vector<double> single = shares(corner);
        corner.insert(corner.begin() + 2, corner[2]);
        const std::vector<double> twice = shares(corner);
        CHECK(twice[2] + twice[3] == Approx(single[2]).epsilon(1e-12));
        CHECK(twice[0] == Approx(single[0]).epsilon(1e-12));
    }
}

TEST_CASE("polygons without area have equal shares", "[contact][surfaces]")
{
    CHECK(shares({Vec3(1, 2, 3)}) == std::vector<double>{1});
    CHECK(shares({Vec3(1, 2, 3), Vec3(2, 2, 3)}) == std::vector<double>{0.5, 0.5});
    CHECK(shares({Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(2, 0, 0), Vec3(1, 0, 0)}) ==
          std::vector<double>{0.25, 0.25, 0.25, 0.25});
    CHECK(shares({}).empty());
}

TEST_CASE("the share of a vertex is that of the face that lies on the plane", "[contact][surfaces]")
{
    // a wedge: a triangle along y, whose faces have three and four corners
    const contact::Polytope wedge({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 2, 0}, {1, 2, 0}, {0, 2, 1}}, 0,
                                  "convex");
    for (const contact::Polytope::Face& f : wedge.face) {
        double sum = 0;
        for (const int v : f.vertex) sum += wedge.share_of_vertex(v, f.n);
        // the faces of the wedge meet at 45 degrees or more
        CHECK(sum == Approx(1).margin(0.02));
    }
    const contact::Polytope box = contact::Polytope::box({0.2, 0.3, 0.4});
    tests::Random random(3);
    for (int v = 0; v < 8; ++v) CHECK(box.share_of_vertex(v, random.unit()) == Approx(0.25).epsilon(1e-14));
    CHECK(contact::Polytope::capsule(1, 0.1).share_of_vertex(1, random.unit()) == 0.5);
}

}  // namespace area_shares_tests
