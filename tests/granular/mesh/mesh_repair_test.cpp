// SPDX-License-Identifier: GPL-3.0-or-later
// Welding of vertices with different rounding errors, and orientation of two-sided meshes.
#include "granular/mesh/mesh_repair.hpp"
#include "granular/backend/split_mix.hpp"
#include "granular/mesh/mesh_shapes.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::granular;

namespace mesh_repair_test {

namespace {

/// The same triangles with three vertices each, which differ by up to `apart` from those of the mesh
TriangleMesh apart(const TriangleMesh& mesh, double distance, hilda::granular::Random& random)
{
    TriangleMesh soup;
    for (const auto& t : mesh.triangle) {
        const auto first = static_cast<std::uint32_t>(soup.vertex.size());
        for (const std::uint32_t v : t) soup.vertex.push_back(mesh.vertex[v] + distance * random.direction());
        soup.triangle.push_back({first, first + 1, first + 2});
    }
    return soup;
}

}  // namespace

TEST_CASE("vertices within 1e-9 of the size of a mesh are joined", "[granular][mesh]")
{
    const double scale = GENERATE(1e-6, 1., 1e4), offset = GENERATE(0., 3.),
                 part = GENERATE(0., 1e-12, 4e-10);
    CAPTURE(scale, offset, part);
    Random random(5);
    TriangleMesh sphere = sphere_mesh(0.5, 2);
    for (Vec3& v : sphere.vertex) v = scale * (v + Vec3{offset, -offset, 2 * offset});
    TriangleMesh soup = apart(sphere, part * scale, random);
    REQUIRE(open_edges(soup) == 3 * soup.triangle.size());
    const Welded welded = weld(soup);
    CHECK(open_edges(soup) == 0);
    CHECK_NOTHROW(check_mesh(soup, "soup"));
    CHECK(soup.triangle.size() == sphere.triangle.size());
    CHECK(welded.triangles == 0);
    if (part > 1e-11) CHECK(welded.vertices == soup.vertex.size() - sphere.vertex.size());
    CHECK(welded.distance <= 1.01e-9 * scale);
}

TEST_CASE("vertices farther apart than 1e-9 of the size of a mesh are not joined", "[granular][mesh]")
{
    Random random(6);
    TriangleMesh soup = apart(sphere_mesh(0.5, 1), 1e-6, random);
    const std::size_t edges = open_edges(soup);
    CHECK(weld(soup).vertices == 0);
    CHECK(open_edges(soup) == edges);
}

TEST_CASE("copies of triangles and triangles without an area after welding are removed", "[granular][mesh]")
{
    TriangleMesh mesh = sphere_mesh(1, 1);
    const std::size_t count = mesh.triangle.size();
    mesh.triangle.push_back({mesh.triangle[3][1], mesh.triangle[3][2], mesh.triangle[3][0]});
    mesh.vertex.push_back(mesh.vertex[0] + Vec3{1e-12, 0, 0});
    mesh.triangle.push_back({0, static_cast<std::uint32_t>(mesh.vertex.size() - 1), mesh.triangle[0][1]});
    const Welded welded = weld(mesh);
    CHECK(welded.triangles == 2);
    CHECK(mesh.triangle.size() == count);
}

TEST_CASE("copies of triangles of any orientation are removed from a two-sided mesh", "[granular][mesh]")
{
    TriangleMesh mesh = plate_mesh(1, 1, 0.5);
    const std::size_t count = mesh.triangle.size();
    mesh.triangle.push_back({mesh.triangle[1][2], mesh.triangle[1][1], mesh.triangle[1][0]});
    mesh.triangle.push_back(mesh.triangle[0]);
    CHECK(remove_copies(mesh) == 2);
    CHECK(mesh.triangle.size() == count);
    CHECK_NOTHROW(check_mesh(mesh, "mesh"));
}

TEST_CASE("orientation turns the triangles that differ from their neighbours", "[granular][mesh]")
{
    const auto seed = GENERATE(range(1, 21));
    Random random(static_cast<std::uint64_t>(seed));
    TriangleMesh mesh = seed % 2 == 0 ? sphere_mesh(1, 2) : plate_mesh(1, 2, 0.2);
    const TriangleMesh before = mesh;
    std::size_t turned = 0;
    for (std::size_t t = 1; t < mesh.triangle.size(); ++t)
        if (random.number(0, 1) < 0.3) std::swap(mesh.triangle[t][0], mesh.triangle[t][1]), ++turned;
    REQUIRE(turned > 0);
    CHECK_THROWS(check_mesh(mesh, "mesh"));
    CHECK(orient(mesh) == turned);
    CHECK_NOTHROW(check_mesh(mesh, "mesh"));
    CHECK(std::abs(mass_properties(mesh).volume - mass_properties(before).volume) < 1e-12);
}

}  // namespace mesh_repair_test
