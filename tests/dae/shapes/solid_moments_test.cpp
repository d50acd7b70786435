// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the mass properties of polyhedra against closed forms.
#include <catch2/catch.hpp>

#include "dae/body_shape.hpp"
#include "dae/shapes/convex_hull.hpp"
#include "tests/support/random_motion.hpp"

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

std::vector<Vec3> corners_of_box(const Vec3& side)
{
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
        corners.push_back(
            0.5 *
            Vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1).cwiseProduct(side));
    return corners;
}

}  // namespace

TEST_CASE("a convex shape with the corners of a box has the mass properties of the box", "[dae][shape]")
{
    const Vec3 side = GENERATE(Vec3(1, 1, 1), Vec3(0.3, 0.2, 0.7), Vec3(1e-3, 2e-3, 5e-3));
    const dae::BodyShape box{"box", {side.x(), side.y(), side.z()}},
        convex = dae::BodyShape::convex(corners_of_box(side), dae::hull_tolerance);
    CHECK(convex.volume() == Approx(box.volume()).epsilon(1e-14));
    CHECK(convex.centroid().norm() < 1e-14 * side.norm());
    CHECK((convex.inertia(3) - box.inertia(3)).norm() < 1e-14 * box.inertia(3).norm());
    CHECK(convex.inertia(3).isDiagonal(0));
}

TEST_CASE("the mass properties of a tetrahedron are those of the closed form, in every pose", "[dae][shape]")
{
    tests::Random random(GENERATE(range(1u, 6u)));
    const double a = random.number(0.1, 2), b = random.number(0.1, 2), c = random.number(0.1, 2);
    const Mat3 A = random.rotation();
    const Vec3 r(random.number(-5, 5), random.number(-5, 5), random.number(-5, 5));
    std::vector<Vec3> corners = {{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}};
    for (Vec3& x : corners) x = r + A * x;
    const dae::BodyShape shape = dae::BodyShape::convex(corners, dae::hull_tolerance);
    Mat3 J;  // about the centroid, of a mass of 80 kg
    J << 3 * (b * b + c * c), a * b, a * c, a * b, 3 * (a * a + c * c), b * c, a * c, b * c,
        3 * (a * a + b * b);
    CHECK(shape.volume() == Approx(a * b * c / 6).epsilon(1e-12));
    CHECK((shape.centroid() - r - A * Vec3(a, b, c) / 4).norm() < 1e-13);
    CHECK((shape.inertia(80) - A * J * A.transpose()).norm() < 1e-12 * J.norm());
}

TEST_CASE("points of faces and edges beside the corners do not change the moments", "[dae][shape]")
{
    const Vec3 side(0.4, 0.2, 0.6);
    std::vector<Vec3> points = corners_of_box(side);
    const dae::BodyShape box = dae::BodyShape::convex(points, dae::hull_tolerance);
    points.emplace_back(0.2, 0.05, 0.1);
    points.emplace_back(0.2, 0.1, 0);
    const dae::BodyShape same = dae::BodyShape::convex(points, dae::hull_tolerance);
    CHECK(same.volume() == Approx(box.volume()).epsilon(1e-14));
    CHECK((same.inertia(3) - box.inertia(3)).norm() < 1e-14 * box.inertia(3).norm());
}

TEST_CASE("a shape that is not convex, or flat, is refused", "[dae][shape]")
{
    std::vector<Vec3> points = corners_of_box(Vec3(0.4, 0.2, 0.6));
    points.emplace_back(0, 0.05, 0);
    CHECK_THROWS_WITH(dae::BodyShape::convex(points, dae::hull_tolerance),
                      Catch::Contains("the vertices must be those of a convex body, got vertex 8, which lies "
                                      "0.05 m inside of their hull"));
    CHECK_THROWS_WITH(
        dae::BodyShape::convex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, dae::hull_tolerance),
        Catch::Contains("must not lie in a plane"));
    CHECK_THROWS_WITH(dae::BodyShape::convex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, dae::hull_tolerance),
                      Catch::Contains("needs at least 4 vertices, got 3"));
    CHECK_THROWS_WITH(
        dae::BodyShape::convex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}, dae::hull_tolerance),
        Catch::Contains("vertex 3 must be finite"));
}
