// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangle meshes: validation, closest points, OBJ files; convergence of the fitted surface, its normal and
/// its curvature.

#include "contact/mesh/mesh_surface.hpp"
#include "contact/detection/detector.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/check.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/icosphere.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <ctime>
#include <limits>
#include <sstream>

using namespace hilda;
using namespace hilda::contact;
using tests::derivative;
using tests::icosphere;
using tests::image;
using tests::Random;
using tests::Triangles;

namespace {

TriangleMesh ellipsoid_mesh(const Vec3& D, int levels)
{
    return image(icosphere(levels), [&](const Vec3& v) { return Vec3(D.cwiseProduct(v)); });
}

/// The root mean square errors of position, normal and shape operator of a mesh whose vertices lie on an
/// ellipsoid. The vertices are displaced along the ellipsoid by up to `jitter` edge lengths.
Vec3 mesh_errors(const Vec3& D, int levels, double jitter)
{
    Random random(1);
    const double edge = 1.2 * std::pow(0.5, levels);
    const MeshSurface mesh(image(icosphere(levels), [&](const Vec3& v) {
        return Vec3(D.cwiseProduct((v + random.vector(jitter * edge)).normalized()));
    }));
    const Ellipsoid exact(D);
    Vec3 squares = Vec3::Zero();
    constexpr int points = 300;
    for (int k = 0; k < points; ++k) {
        const Vec3 a = *exact.support(random.unit()), x = mesh.project(a), there = exact.project(x);
        squares += Vec3((x - a).squaredNorm(), (mesh.normal(x) - exact.normal(there)).squaredNorm(),
                        (mesh.shape_operator(x) - exact.shape_operator(there)).squaredNorm());
    }
    return (squares / points).cwiseSqrt();
}

std::string refusal_of_mesh(const Triangles& mesh)
{
    try {
        MeshSurface(TriangleMesh(mesh.vertices, mesh.triangles));
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
    return "accepted";
}

Triangles tetrahedron()
{
    return {{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
            {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

}  // namespace

TEST_CASE("position, normal and curvature of a mesh surface converge with orders 4, 3 and 2",
          "[contact][mesh]")
{
    const Vec3 coarse = mesh_errors({1, 0.9, 1.1}, 2, 0.1), fine = mesh_errors({1, 0.9, 1.1}, 3, 0.1);
    const Vec3 order = (coarse.cwiseQuotient(fine).array().log() / std::log(2)).matrix();
    INFO("errors " << coarse.transpose() << " and " << fine.transpose() << ", orders " << order.transpose());
    CHECK(order[0] == Approx(4).margin(0.2));
    CHECK(order[1] == Approx(3).margin(0.2));
    CHECK(order[2] == Approx(2).margin(0.2));
    CHECK(fine[0] < 2e-4);
    CHECK(fine[1] < 1e-3);
    CHECK(fine[2] < 2e-2);
}

TEST_CASE("the derivatives of a mesh surface agree with finite differences", "[contact][mesh]")
{
    static const MeshSurface s(ellipsoid_mesh({0.9, 0.7, 1.2}, 3));
    Random random(GENERATE(range(0u, 20u)));
    const Vec3 u = random.unit(), a = Vec3(0.9, 0.7, 1.2).cwiseProduct(u) + random.vector(0.02);
    const auto [G, gradient, hessian] = s.derivatives(a);
    CHECK(G == s.value(a));
    CHECK(hessian == hessian.transpose());
    // the step is small because the third derivatives jump at the border of a patch
    constexpr double step = 2e-5;
    for (int k = 0; k < 3; ++k) {
        const auto moved = [&](double tau) { return Vec3(a + tau * Vec3::Unit(k)); };
        CHECK(gradient[k] ==
              Approx(derivative([&](double tau) { return s.value(moved(tau)); }, step)).margin(1e-9));
        CHECK((hessian.col(k) - derivative([&](double tau) { return s.gradient(moved(tau)); }, step)).norm() <
              1e-7);
    }
}

TEST_CASE("normal and curvature of a mesh surface are continuous across triangles", "[contact][mesh]")
{
    const TriangleMesh mesh = ellipsoid_mesh({0.9, 0.7, 1.2}, 3);
    const MeshSurface s(mesh);
    constexpr double step = 1e-9;
    double most = 0;
    for (size_t k = 0; k < mesh.triangles.size(); k += 23) {
        const auto& [a, b, c] = mesh.triangles[k];
        const Vec3 edge = mesh.vertices[b] - mesh.vertices[a], middle = mesh.vertices[a] + 0.4 * edge;
        const Vec3 across = mesh.face_normal[k].cross(edge).normalized();
        const Vec3 one = middle + step * across, other = middle - step * across;
        CHECK(mesh.nearest(one).triangle != mesh.nearest(other).triangle);
        most = std::max(most, (s.hessian(one) - s.hessian(other)).norm() / s.hessian(middle).norm());
        CHECK((s.normal(one) - s.normal(other)).norm() < 10 * step);
    }
    CHECK(most < 100 * step);
}

TEST_CASE("the closest triangle is found and its pseudonormal distinguishes inside and outside",
          "[contact][mesh]")
{
    const Vec3 D(0.9, 0.7, 1.2);
    static const TriangleMesh mesh = ellipsoid_mesh(D, 3);
    const Ellipsoid exact(D);
    Random random(GENERATE(range(0u, 20u)));
    const Vec3 a = 1.5 * random.vector();
    const TriangleMesh::Nearest near = mesh.nearest(a);
    double least = INFINITY;
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
        least = std::min(least, mesh.distance(t, a));
    CHECK(near.distance == least);
    CHECK(near.distance == (a - near.point).norm());
    const double depth = exact.value(a);
    if (std::abs(depth) > 0.02)
        CHECK((a - near.point).dot(mesh.normal(near.triangle, near.feature)) * depth > 0);
}

TEST_CASE("far from a mesh G is the signed distance to the triangles", "[contact][mesh]")
{
    static const MeshSurface s(ellipsoid_mesh({0.9, 0.7, 1.2}, 3));
    CHECK(s.size() == Approx(std::cbrt(0.9 * 0.7 * 1.2)).epsilon(0.02));
    Random random(GENERATE(range(0u, 20u)));
    for (const double scale : {0.4, 2.0}) {
        const Vec3 a = scale * Vec3(0.9, 0.7, 1.2).cwiseProduct(random.unit());
        const auto [G, gradient, hessian] = s.derivatives(a);
        CHECK(G * (scale - 1) > 0);
        CHECK(std::abs(G) == Approx(s.mesh.nearest(a).distance).epsilon(1e-14));
        CHECK(gradient.norm() == Approx(1).epsilon(1e-14));
        if (scale < 1) continue;  // inside, the closest triangle may change within the step
        for (int k = 0; k < 3; ++k)
            CHECK((hessian.col(k) -
                   derivative([&](double tau) { return s.gradient(a + tau * Vec3::Unit(k)); }, 1e-6))
                      .norm() < 1e-7);
        const Vec3 x = s.project(a);
        CHECK(std::abs(s.value(x)) < 1e-14);
        CHECK((a - x).cross(s.normal(x)).norm() < 3e-14);
    }
}

TEST_CASE("a mesh surface rotates, moves and scales with its mesh", "[contact][mesh]")
{
    Random random(GENERATE(range(0u, 5u)));
    const Mat3 A = random.rotation();
    const Vec3 D(1, 0.85, 1.15), o = random.vector(3);
    const double grown = std::exp(random.number(-5, 5));
    const MeshSurface s(ellipsoid_mesh(D, 2));
    const MeshSurface moved(
        image(icosphere(2), [&](const Vec3& v) { return Vec3(o + grown * A * D.cwiseProduct(v)); }));
    for (int k = 0; k < 10; ++k) {
        const Vec3 a = D.cwiseProduct(random.unit()) + random.vector(0.05), there = o + grown * A * a;
        CHECK(moved.value(there) == Approx(grown * s.value(a)).margin(1e-13 * (grown + o.norm())));
        CHECK((moved.normal(there) - A * s.normal(a)).norm() < 1e-12 * (1 + o.norm() / grown));
        CHECK((grown * moved.shape_operator(there) - A * s.shape_operator(a) * A.transpose()).norm() <
              1e-11 * (1 + o.norm() / grown));
    }
}

TEST_CASE("parts of a mesh that are closer than an edge length do not influence each other",
          "[contact][mesh]")
{
    const Triangles one = icosphere(2);
    const Vec3 apart(2.05, 0, 0);
    Triangles two = one;
    const int n = static_cast<int>(one.vertices.size());
    for (const Vec3& v : one.vertices) two.vertices.push_back(v + apart);
    for (const auto& [a, b, c] : one.triangles) two.triangles.push_back({a + n, b + n, c + n});
    const MeshSurface alone(TriangleMesh(one.vertices, one.triangles));
    const MeshSurface both(TriangleMesh(two.vertices, two.triangles));
    for (const Vec3& a : {Vec3(1, 0, 0), Vec3(1.02, 0, 0), Vec3(0.98, 0.05, 0.03), Vec3(0.99, 0, 0.1)}) {
        const auto [G, gradient, hessian] = both.derivatives(a);
        CHECK(G == alone.value(a));
        CHECK(gradient == alone.gradient(a));
        CHECK(hessian == alone.hessian(a));
        CHECK(both.value(apart - a) == Approx(G).epsilon(1e-9));
    }
}

TEST_CASE("the contact point of a ball and a mesh is that of the meshed surface", "[contact][mesh]")
{
    const Vec3 D(0.9, 0.7, 1.2);
    const double R = 0.2;
    const Shape ball{std::make_shared<Sphere>(R)}, egg{std::make_shared<Ellipsoid>(D)};
    static const auto meshed = std::make_shared<MeshSurface>(ellipsoid_mesh(D, 3));
    Random random(GENERATE(range(0u, 10u)));
    lie::Motion b_i = random.motion(), b_j = random.motion();
    const Vec3 a = *Ellipsoid(D).support(random.unit());
    b_i.r = b_j.r + b_j.A * (a + (R - 1e-3) * Ellipsoid(D).normal(a));
    const ContactPoint exact = make_detector(ball, egg)->detect(b_i, b_j, nullptr);
    const ContactPoint contact_point = make_detector(ball, {meshed})->detect(b_i, b_j, nullptr);
    CHECK(contact_point.gap == Approx(exact.gap).margin(1e-3));
    CHECK((contact_point.n - exact.n).norm() < 5e-3);
    CHECK((contact_point.K_j - exact.K_j).norm() < 0.2);
}

TEST_CASE("a concave mesh has the opposite normal and curvature", "[contact][mesh]")
{
    const MeshSurface body(ellipsoid_mesh({1, 1, 1}, 2)), hollow(ellipsoid_mesh({1, 1, 1}, 2), true);
    const Vec3 a(0.6, 0, 0.8);
    CHECK(body.normal(a) == -hollow.normal(a));
    CHECK(body.normal(a).dot(a) > 0.99);
    CHECK(body.mean_curvature(a) == Approx(1).epsilon(0.1));
    CHECK(hollow.mean_curvature(a) == -body.mean_curvature(a));
    CHECK(std::isnan(body.value({0, std::nan(""), 0})));
    CHECK_THROWS_AS(body.normal({0, 0, INFINITY}), lie::NumericalFailure);
}

TEST_CASE("the evaluation of a mesh surface does not allocate memory", "[contact][mesh][allocation]")
{
    const MeshSurface s(ellipsoid_mesh({1, 1, 1}, 2));
    Vec3 sum = Vec3::Zero();
    CHECK(tests::allocations_during([&] {
              sum += s.derivatives({0.6, 0, 0.8}).gradient + s.normal({0, 0.6, 0.8}) + s.gradient({2, 2, 2});
              sum += s.project({1, 1, 1}) + s.shape_operator({0.8, 0.6, 0}).col(0);
          }) == 0);
    CHECK(sum.allFinite());
}

TEST_CASE("a mesh that is not a closed oriented manifold is rejected with the reason", "[contact][mesh]")
{
    const auto says = [](const Triangles& mesh, const std::string& what) {
        CHECK(refusal_of_mesh(mesh) == "contact::TriangleMesh: " + what);
    };
    Triangles open = tetrahedron();
    open.triangles.pop_back();
    says(open, "the edge of the vertices 1 and 2 is open: it belongs to triangle 0 only");
    Triangles turned = tetrahedron();
    std::swap(turned.triangles[3][0], turned.triangles[3][1]);
    says(turned,
         "the edge of the vertices 1 and 2 has the same direction in triangles 0 and 3: one of them has the "
         "wrong orientation");
    Triangles inside_out = tetrahedron();
    for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
    says(inside_out,
         "the triangles must be counterclockwise as seen from outside: the enclosed volume is -0.166667 m^3");
    Triangles flat = tetrahedron();
    flat.vertices[3] = {0.5, 0, 0};
    says(flat, "triangle 1 has zero area");
    Triangles beyond = tetrahedron();
    beyond.triangles[2][1] = 4;
    says(beyond, "triangle 2 has vertex 4, allowed are 0 to 3");
    Triangles nowhere = tetrahedron();
    nowhere.vertices[2].y() = INFINITY;
    says(nowhere, "vertex 2 is not finite");
    says({{Vec3(0, 0, 0)}, {}}, "a mesh must have triangles");

    Triangles twice = tetrahedron();
    for (const Triangle& t : tetrahedron().triangles) twice.triangles.push_back(t);
    says(twice, "the edge of the vertices 0 and 1 belongs to 4 triangles; it must belong to two");
    // two tetrahedra that share one vertex
    Triangles tips = tetrahedron();
    for (int v = 1; v < 4; ++v) tips.vertices.push_back(-tips.vertices[v]);
    for (const auto& [a, b, c] : tetrahedron().triangles) {
        const auto other = [](int v) { return v == 0 ? 0 : v + 3; };
        tips.triangles.push_back({other(a), other(c), other(b)});
    }
    says(tips, "the mesh is not a manifold: two parts of it share only vertex 0");
}

TEST_CASE("a mesh that is too coarse for a smooth surface is rejected with the vertex", "[contact][mesh]")
{
    CHECK(refusal_of_mesh(tetrahedron()) ==
          "contact::MeshSurface: the mesh is too coarse for a smooth surface: the 4 vertices near vertex 0 "
          "do not "
          "determine a "
          "cubic");
    CHECK_THAT(refusal_of_mesh(icosphere(1)),
               Catch::StartsWith("contact::MeshSurface: the mesh is too coarse for a smooth surface: "
                                 "the normals of the neighbouring vertices 12 and 6 differ by"));
    CHECK(refusal_of_mesh(icosphere(2)) == "accepted");
    Triangles with_more = icosphere(2);
    with_more.vertices.emplace_back(7, 7, 7);
    CHECK(refusal_of_mesh(with_more) == "accepted");
    CHECK(MeshSurface(TriangleMesh(with_more.vertices, with_more.triangles)).size() < 1.01);
}

namespace {

/// A vertex with n triangles, in the middle of the upper side of a flat body that is rounded at its rim
std::pair<std::vector<Vec3>, std::vector<Triangle>> body_with_fan(int n)
{
    constexpr int rings = 8;  // from the upper to the lower pole
    std::vector<Vec3> vertices = {Vec3(0, 0, 1)};
    for (int ring = 1; ring < rings; ++ring)
        for (int k = 0; k < n; ++k) {
            const double theta = M_PI * ring / rings, phi = 2 * M_PI * k / n;
            vertices.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                  std::cos(theta));
        }
    vertices.emplace_back(0, 0, -1);
    std::vector<Triangle> triangles;
    const int last = static_cast<int>(vertices.size()) - 1;
    for (int k = 0; k < n; ++k) {
        const int next = (k + 1) % n;
        triangles.push_back({0, 1 + k, 1 + next});
        for (int ring = 0; ring + 2 < rings; ++ring) {
            const int a = 1 + ring * n + k, b = 1 + ring * n + next;
            triangles.push_back({a, a + n, b});
            triangles.push_back({b, a + n, b + n});
        }
        triangles.push_back({last, last - n + next, last - n + k});
    }
    return {vertices, triangles};
}

}  // namespace

TEST_CASE("a vertex with 14000 triangles is checked in a time proportional to their number (long)",
          "[contact][mesh]")
{
    // Processor time, the shortest of three: other programs on the machine do not change it by much.
    const auto time = [](int n) {
        const auto [vertices, triangles] = body_with_fan(n);
        std::clock_t shortest = std::numeric_limits<std::clock_t>::max();
        for (int k = 0; k < 3; ++k) {
            const std::clock_t begin = std::clock();
            CHECK_FALSE(TriangleMesh::fault(vertices, triangles));
            shortest = std::min(shortest, std::clock() - begin);
        }
        return static_cast<double>(shortest);
    };
    // 14 times as many triangles. A time proportional to the square would be 196 times as long.
    CHECK(time(14000) < 70 * time(1000));
    const auto [vertices, triangles] = body_with_fan(14000);
    CHECK_THROWS_WITH(
        MeshSurface(TriangleMesh(vertices, triangles)),
        Catch::StartsWith("contact::MeshSurface: the triangles near vertex 0 are too narrow: ") &&
            Catch::EndsWith(" vertices are within 0.975 m, 2.5 times its longest edge; the limit is 4000"));
}

TEST_CASE("the surface of a mesh with a vertex of many triangles is that of its sphere (long)",
          "[contact][mesh]")
{
    const auto [vertices, triangles] = body_with_fan(300);
    const MeshSurface mesh{TriangleMesh(vertices, triangles)};
    for (const Vec3& direction : {Vec3(0.01, 0, 1), Vec3(0.3, 0.2, 1), Vec3(1, 0, 0), Vec3(0, -1, -2)}) {
        const Surface::Derivatives G = mesh.derivatives(direction.normalized());
        CHECK(G.G == Approx(0).margin(1e-2));  // cubics on edges of 0.39: 0.39⁴ / 4 = 6e-3
        CHECK((G.gradient.normalized() - direction.normalized()).norm() < 6e-2);
    }
}
