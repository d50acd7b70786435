// SPDX-License-Identifier: GPL-3.0-or-later
// The local minima of the distance to a mesh: one contact for each, whichever triangle it is on.
#include "granular/backend/split_mix.hpp"
#include "granular/core/surfaces/meshes.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>

using namespace hilda;
using namespace hilda::tests;
using granular::Meshes;
using granular::MeshTriangle;
using granular::Nearest;
using granular::TriangleMesh;

namespace {

Meshes meshes_of(const TriangleMesh& mesh, bool two_sided = false)
{
    Meshes all;
    all.add(mesh, 0, two_sided);
    return all;
}

/// The minima that the triangles own, within `reach` of p
std::vector<Nearest> minima(const Meshes& meshes, const Vec3& p, double reach)
{
    std::vector<Nearest> found;
    for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t) {
        const Nearest near = nearest(meshes.view(), t, p, reach);
        if (near.distance < reach) found.push_back(near);
    }
    return found;
}

double least_distance(const Meshes& meshes, const Vec3& p)
{
    double least = 1e300;
    for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t)
        least = std::min(least, (p - closest_point(meshes.view(), t, p)).norm());
    return least;
}

/// There is one minimum within reach, and it is the closest point.
void check_closest_point(const Meshes& meshes, const Vec3& p, double reach)
{
    const std::vector<Nearest> found = minima(meshes, p, reach);
    REQUIRE(found.size() == 1);
    CHECK(found[0].distance == Approx(least_distance(meshes, p)).epsilon(1e-12));
    CHECK(least_distance(meshes, p - found[0].distance * found[0].n) < 1e-14);
}

TriangleMesh turned(TriangleMesh mesh, const granular::EulerParameters<double>& p)
{
    for (Vec3& v : mesh.vertex) v = rotated(p, v);
    return mesh;
}

granular::EulerParameters<double> random_rotation(granular::Random& random)
{
    const Vec3 a = random.direction();
    const double half = random.number(0, 3);
    return {std::cos(half), std::sin(half) * a};
}

}  // namespace

TEST_CASE("the closest point of a triangle is not farther than any other of its points", "[granular][mesh]")
{
    granular::Random random(3);
    const auto point = [&] { return Vec3{random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)}; };
    for (int k = 0; k < 2000; ++k) {
        const Meshes meshes = meshes_of({{point(), point(), point()}, {{0, 1, 2}}});
        const Vec3 p = point(), q = closest_point(meshes.view(), 0, p);
        // q is a point of the triangle at which the distance to p has a minimum
        const Vec3 *v = meshes.vertex.data(), n = meshes.triangle[0].face.n;
        CHECK(std::abs((q - v[0]).dot(n)) < 1e-12);
        for (int e = 0; e < 3; ++e) {
            CHECK((q - v[e]).dot((v[(e + 1) % 3] - v[e]).cross(n)) < 1e-12);
            CHECK((p - q).dot(v[e] - q) < 1e-12);
        }
    }
}

TEST_CASE("a flat mesh has one contact with each grain, that of its plane", "[granular][mesh]")
{
    granular::Random random(7);
    for (int mesh = 0; mesh < 20; ++mesh) {
        // The first mesh is not rotated: the points above its vertices are so exactly.
        const bool exact = mesh == 0;
        const auto rotation =
            exact ? granular::EulerParameters<double>{1, {0, 0, 0}} : random_rotation(random);
        const TriangleMesh flat = granular::plate_mesh(1, 1, 0.125);  // 128 triangles
        const Meshes meshes = meshes_of(turned(flat, rotation));
        REQUIRE(meshes.triangle.size() == 128);
        const double R = 0.1;
        const auto check = [&](double x, double y, double z) {
            const std::vector<Nearest> found = minima(meshes, rotated(rotation, Vec3{x, y, z}), R);
            REQUIRE(found.size() == 1);
            CHECK(found[0].distance == Approx(z).margin(1e-15));
            CHECK((found[0].n - rotated(rotation, Vec3{0, 0, 1})).norm() < 1e-14);
        };
        for (int k = 0; k < 50; ++k)
            check(random.number(-0.5, 0.5), random.number(-0.5, 0.5), random.number(0, R));
        // above edges, diagonals and vertices
        for (int i = -7; i < 8; ++i)
            for (int j = -7; j < 8; ++j)
                if (exact || i % 2 != 0 || j % 2 != 0) check(i / 16., j / 16., 0.09);
        CHECK(minima(meshes, rotated(rotation, Vec3{0.01, 0.02, -0.05}), R).empty());  // behind
    }
}

TEST_CASE("outside of a sphere of triangles a grain has one contact, the closest point", "[granular][mesh]")
{
    granular::Random random(9);
    const Meshes meshes = meshes_of(granular::sphere_mesh(1, 2));  // 320 triangles
    REQUIRE(meshes.triangle.size() == 320);
    const double R = 0.3;
    for (int k = 0; k < 1000; ++k) {
        const Vec3 p = random.number(1.001, 1.25) * random.direction();
        check_closest_point(meshes, p, R);
    }
    for (const Vec3& v : meshes.vertex) {  // above vertices and edges
        REQUIRE(minima(meshes, 1.1 * v, R).size() == 1);
        CHECK(minima(meshes, 1.1 * v, R)[0].distance == Approx(0.1).epsilon(1e-12));
    }
    for (const MeshTriangle& t : meshes.triangle)
        CHECK(minima(meshes, 0.55 * (meshes.vertex[t.vertex[0]] + meshes.vertex[t.vertex[1]]), R).size() ==
              1);
}

TEST_CASE("inside of a cube of triangles the contacts are those of its planes", "[granular][mesh]")
{
    granular::Random random(11);
    const bool inside = true;
    const Meshes meshes = meshes_of(granular::box_mesh({0, 0, 0}, {1, 1, 1}, {}, inside, 1 / 3.));
    REQUIRE(meshes.triangle.size() == 108);
    const double R = 0.2;
    int corners = 0;
    for (int k = 0; k < 1000; ++k) {
        const Vec3 p{random.number(0.01, 0.99), random.number(0.01, 0.99), random.number(0.01, 0.99)};
        std::vector<double> planes;
        for (const double x : {p.x, 1 - p.x, p.y, 1 - p.y, p.z, 1 - p.z})
            if (x < R) planes.push_back(x);
        std::vector<double> found;
        for (const Nearest& near : minima(meshes, p, R)) found.push_back(near.distance);
        std::sort(planes.begin(), planes.end()), std::sort(found.begin(), found.end());
        REQUIRE(found.size() == planes.size());
        for (std::size_t m = 0; m < found.size(); ++m) CHECK(found[m] == Approx(planes[m]).margin(1e-14));
        corners += found.size() == 3 ? 1 : 0;
    }
    CHECK(corners > 10);
}

TEST_CASE("outside of a cube a grain has one contact with a face, an edge or a corner", "[granular][mesh]")
{
    granular::Random random(13);
    const Meshes meshes = meshes_of(granular::box_mesh({0, 0, 0}, {1, 1, 1}, {}, false, 0.5));
    const double R = 0.4;
    for (int k = 0; k < 2000; ++k) {
        const Vec3 p{random.number(-0.3, 1.3), random.number(-0.3, 1.3), random.number(-0.3, 1.3)};
        const Vec3 q{std::clamp(p.x, 0., 1.), std::clamp(p.y, 0., 1.), std::clamp(p.z, 0., 1.)};
        const std::vector<Nearest> found = minima(meshes, p, R);
        const double distance = (p - q).norm();
        if (distance == 0) {
            CHECK(found.empty());  // behind all triangles
        } else if (distance < R) {
            REQUIRE(found.size() == 1);
            CHECK(found[0].distance == Approx(distance).margin(1e-14));
            CHECK((found[0].n - (1 / distance) * (p - q)).norm() < 1e-12);
        }
    }
}

TEST_CASE("a two-sided plate has contacts on both sides and at its rim", "[granular][mesh]")
{
    granular::Random random(17);
    const bool two_sided = GENERATE(false, true);
    const Meshes meshes = meshes_of(granular::plate_mesh(1, 1, 0.25), two_sided);
    const double R = 0.2;
    for (int k = 0; k < 2000; ++k) {
        const Vec3 p{random.number(-0.8, 0.8), random.number(-0.8, 0.8), random.number(-0.3, 0.3)};
        const Vec3 d = p - Vec3{std::clamp(p.x, -0.5, 0.5), std::clamp(p.y, -0.5, 0.5), 0};
        const std::vector<Nearest> found = minima(meshes, p, R);
        const bool in_contact = d.norm() < R && (two_sided || p.z > 0);
        REQUIRE(found.size() == (in_contact ? 1 : 0));
        if (in_contact) CHECK((found[0].distance * found[0].n - d).norm() < 1e-13);
    }
}

TEST_CASE("a wall on a floor of one mesh has the contacts of two plates", "[granular][mesh]")
{
    // The floor z = 0 is divided at x = 0, where the wall x = 0 begins: three triangles at the edges of the
    // foot. The orientation of the triangles is arbitrary.
    granular::Random random(29);
    TriangleMesh shape;
    for (const double y : {-1., 0., 1.})
        for (const Vec3& v : {Vec3{-1, y, 0}, Vec3{0, y, 0}, Vec3{1, y, 0}, Vec3{0, y, 1}})
            shape.vertex.push_back(v);
    for (const std::uint32_t k : {0u, 4u})
        for (const auto& [a, b] : {std::pair{0u, 1u}, {1u, 2u}, {1u, 3u}})
            shape.triangle.push_back({k + a, k + b, k + b + 4}),
                shape.triangle.push_back({k + a, k + b + 4, k + a + 4});
    for (auto& t : shape.triangle)
        if (random.number() < 0.5) std::swap(t[1], t[2]);
    CHECK_NOTHROW(check_mesh(TriangleMesh{shape.vertex, {{1, 5, 0}, {1, 5, 2}, {1, 5, 3}}}, "fan", true));
    const Meshes meshes = meshes_of(shape, true);
    const double R = 0.3;
    for (int k = 0; k < 4000; ++k) {
        Vec3 p{random.number(-0.5, 0.5), random.number(-0.9, 0.9), random.number(-0.4, 1.5)};
        if (k % 4 == 0) p.x = 0;
        if (k % 8 == 1) p.y = 0;
        std::vector<double> expected;
        if (std::abs(p.z) < R && (p.x != 0 || p.z < 0)) expected.push_back(std::abs(p.z));
        if (p.z > 0 && p.x != 0) {
            const double to_wall = std::hypot(p.x, std::max(p.z - 1, 0.));
            if (to_wall < R) expected.push_back(to_wall);
        } else if (p.z > 1 && p.z - 1 < R) {
            expected.push_back(p.z - 1);
        }
        if (p.x == 0 && p.z > 0 && p.z <= 1) continue;  // on the wall
        std::vector<double> found;
        for (const Nearest& near : minima(meshes, p, R)) found.push_back(near.distance);
        std::sort(found.begin(), found.end()), std::sort(expected.begin(), expected.end());
        CAPTURE(p.x, p.y, p.z);
        REQUIRE(found.size() == expected.size());
        for (std::size_t n = 0; n < found.size(); ++n) CHECK(std::abs(found[n] - expected[n]) < 1e-12);
        for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t)
            if (distance_to_ownership(meshes.view(), t, p) > 1e-12)
                CHECK_FALSE(nearest(meshes.view(), t, p, R).distance < R);
    }
}

TEST_CASE("inside of a sphere of triangles a grain has one contact, with the closest one", "[granular][mesh]")
{
    granular::Random random(23);
    TriangleMesh shape = granular::sphere_mesh(1, 2);  // angles between the normals up to 18 degrees
    for (auto& t : shape.triangle) std::swap(t[1], t[2]);
    const Meshes meshes = meshes_of(shape);
    const double R = 0.15;
    for (int k = 0; k < 2000; ++k) {
        const Vec3 p = random.number(0.87, 0.97) * random.direction();
        check_closest_point(meshes, p, R);
    }
}

TEST_CASE("a triangle owns no minimum within its distance to ownership", "[granular][mesh]")
{
    granular::Random random(19);
    const double slack = 0.05;
    const TriangleMesh shape =
        GENERATE(granular::sphere_mesh(0.5, 2), granular::plate_mesh(1, 1, 0.125),
                 granular::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {}, true, 0.2));
    const bool two_sided = GENERATE(false, true);
    const Meshes meshes = meshes_of(shape, two_sided);
    long listed = 0, owned = 0, close = 0;
    for (int k = 0; k < 500; ++k) {
        const Vec3 p{random.number(-0.6, 0.6), random.number(-0.6, 0.6), random.number(-0.6, 0.6)};
        for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t) {
            const double away = distance_to_ownership(meshes.view(), t, p);
            const bool may = away <= slack;
            close += (p - closest_point(meshes.view(), t, p)).norm() < 0.3 ? 1 : 0;
            listed += may && (p - closest_point(meshes.view(), t, p)).norm() < 0.3 ? 1 : 0;
            for (int m = 0; m < 20; ++m) {
                const Vec3 moved = p + random.number(0, slack) * random.direction();
                if (nearest(meshes.view(), t, moved, 1).distance < 1) {
                    ++owned;
                    REQUIRE((moved - p).norm() >= (1 - 1e-12) * away);
                }
            }
        }
    }
    CHECK(owned > 1000);
    CHECK(5 * listed < 3 * close);
}

TEST_CASE("a minimum in a face remains there within the distance in the face", "[granular][mesh]")
{
    granular::Random random(29);
    TriangleMesh bowl = granular::sphere_mesh(0.5, 2);  // smooth concave edges
    for (auto& t : bowl.triangle) std::swap(t[1], t[2]);
    const std::array<TriangleMesh, 3> shapes{
        bowl, granular::sphere_mesh(0.5, 2),
        granular::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {}, true, 0.2)};
    const TriangleMesh& shape = shapes[GENERATE(0u, 1u, 2u)];
    const bool two_sided = GENERATE(false, true);
    const Meshes meshes = meshes_of(shape, two_sided);
    long inside = 0;
    for (int k = 0; k < 1000; ++k) {
        const Vec3 p{random.number(-0.6, 0.6), random.number(-0.6, 0.6), random.number(-0.6, 0.6)};
        for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t) {
            const MeshTriangle& T = meshes.triangle[t];
            const double least = distance_in_face(meshes.view(), t, p), side = T.face.height(p) < 0 ? -1 : 1;
            if (!(least > 0)) continue;
            ++inside;
            CHECK(distance_to_ownership(meshes.view(), t, p) <= 0);
            for (int m = 0; m < 20; ++m) {
                const Vec3 moved = p + (1 - 1e-9) * least * random.direction();
                const Nearest near = nearest(meshes.view(), t, moved, 2);
                REQUIRE(near.distance == side * T.face.height(moved));
                REQUIRE(near.n == side * T.face.n);
            }
        }
    }
    CHECK(inside > 200);
}
