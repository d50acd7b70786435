// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/body_drawing.hpp"

#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// Volume and inertia about the origin of a homogeneous polyhedron of unit density, summed over the
/// tetrahedra from the origin to the triangles of its faces
struct Polyhedron {
    double volume = 0;
    Mat3 J = Mat3::Zero();

    explicit Polyhedron(const contact::PolygonMesh& mesh)
    {
        Mat3 moments = Mat3::Zero();  // ∫ a aᵀ dV
        for (const std::vector<int>& face : mesh.polygon)
            for (size_t k = 1; k + 1 < face.size(); ++k) {
                const Vec3 &p = mesh.point[face[0]], &q = mesh.point[face[k]], &s = mesh.point[face[k + 1]];
                const double V = p.dot(q.cross(s)) / 6;
                const Vec3 sum = p + q + s;
                volume += V;
                moments +=
                    V / 20 *
                    (sum * sum.transpose() + p * p.transpose() + q * q.transpose() + s * s.transpose());
            }
        J = moments.trace() * Mat3::Identity() - moments;
    }
};

}  // namespace

TEST_CASE("the solid that is drawn for a body has the inertia of the body", "[run][vtk]")
{
    tests::Random random(GENERATE(range(1u, 6u)));
    const Vec3 side(random.number(0.1, 2), random.number(0.1, 2), random.number(0.1, 2));
    dae::Body body{.name = "box", .m = random.number(0.1, 5)};
    const Mat3 R = random.rotation();
    const Vec3 squares = side.cwiseAbs2();
    body.J_bar =
        R * Vec3(body.m / 12 * (squares.sum() * Vec3::Ones() - squares)).asDiagonal() * R.transpose();
    const Polyhedron box(run::equivalent_solid(body));
    CHECK(box.volume == Approx(side.prod()).epsilon(1e-9));  // positive: the polygons are oriented outward
    CHECK((body.m / box.volume * box.J - body.J_bar).norm() < 1e-9 * body.J_bar.norm());
}

TEST_CASE("a body with equal moments is drawn as a sphere, and a slender bar with a visible thickness",
          "[run][vtk]")
{
    const dae::Body ball{.name = "ball", .m = 3, .J_bar = 0.4 * 3 * 0.25 * 0.25 * Mat3::Identity()};
    const contact::PolygonMesh sphere = run::equivalent_solid(ball);
    for (const Vec3& a : sphere.point) CHECK(a.norm() == Approx(0.25).epsilon(1e-12));
    CHECK(sphere.polygon.size() > 100);

    const dae::Body bar{.name = "bar", .m = 2, .J_bar = Vec3(1e-12, 2. / 12, 2. / 12).asDiagonal()};
    Eigen::AlignedBox3d box;
    for (const Vec3& a : run::equivalent_solid(bar).point) box.extend(a);
    CHECK(box.sizes().isApprox(Vec3(1, 0.02, 0.02), 1e-6));
}

TEST_CASE("a body with a shape is drawn as this shape", "[run][vtk]")
{
    const dae::BodyShape tetrahedron = dae::BodyShape::convex(
        {{-0.1, -0.1, -0.2}, {0.3, -0.1, -0.2}, {-0.1, 0.3, -0.2}, {-0.1, -0.1, 0.6}}, 1e-9);
    const std::vector<dae::BodyShape> shapes = {{.type = "box", .dimensions = {0.1, 0.2, 0.3}},
                                                {.type = "sphere", .dimensions = {0.2}},
                                                {.type = "ellipsoid", .dimensions = {0.1, 0.2, 0.3}},
                                                {.type = "cylinder", .dimensions = {0.1, 0.5}, .axis = 0},
                                                {.type = "capsule", .dimensions = {0.1, 0.3}, .axis = 0},
                                                {.type = "cone", .dimensions = {0.2, 0.6}, .axis = 1},
                                                tetrahedron};
    for (const dae::BodyShape& shape : shapes) {
        CAPTURE(shape.type);
        dae::Body body{.name = shape.type, .m = 2, .J_bar = shape.inertia(2)};
        body.shape = shape;
        const Polyhedron drawn(run::body_drawing(body));
        // Inscribed polyhedra: the volume is smaller, by up to 8 % for the ellipsoid; the orientation is
        // outward.
        const double margin = shape.type == "box" || shape.type == "convex" ? 1e-12 : 0.08;
        CHECK(drawn.volume == Approx(shape.volume()).epsilon(margin));
        CHECK((2 / drawn.volume * drawn.J - shape.inertia(2)).norm() < margin * shape.inertia(2).norm());
    }
}
