// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle meshes: their faults, open edges and mass properties.
#include "granular/core/surfaces/triangle_mesh.hpp"

#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

using namespace hilda;
using namespace hilda::granular;

namespace {

/// The tetrahedron of the origin and the unit points of the axes, with the normals outwards
TriangleMesh tetrahedron()
{
    return {.vertex = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            .triangle = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// Message of check_mesh; "nothing" if the mesh is accepted
std::string fault(const TriangleMesh& mesh)
{
    try {
        check_mesh(mesh, "m");
        return "nothing";
    } catch (const io::InvalidInput& e) {
        return e.what();
    }
}

template <class F>
TriangleMesh image(TriangleMesh mesh, const F& f)
{
    for (Vec3& v : mesh.vertex) v = f(v);
    return mesh;
}

}  // namespace

TEST_CASE("check_mesh names the triangle and the value of a fault", "[granular][mesh]")
{
    CHECK(fault(tetrahedron()) == "nothing");
    CHECK(fault({}) == "m: a mesh must have a triangle, got none");

    TriangleMesh m = tetrahedron();
    m.triangle.resize(TriangleMesh::most_triangles + 1);
    CHECK(fault(m) == "m: a mesh must have at most 4194304 triangles, got 4194305");

    m = tetrahedron();
    m.triangle[2][1] = 4;
    CHECK(fault(m) == "m: triangle 2 must have vertices below 4, got 4");
    m.triangle[2][1] = std::numeric_limits<std::uint32_t>::max();
    CHECK(fault(m) == "m: triangle 2 must have vertices below 4, got 4294967295");
    m = tetrahedron();
    m.vertex.clear();
    CHECK(fault(m) == "m: triangle 0 must have vertices below 0, got 0");

    m = tetrahedron();
    m.vertex[3].y = std::nan("");
    CHECK(fault(m) == "m: triangle 1 must have finite vertices, got (0, nan, 1) at vertex 3");
    m = tetrahedron();
    m.vertex.push_back({0, 0, -std::numeric_limits<double>::infinity()});
    CHECK(fault(m) == "m: vertex 4 must be finite, got (0, 0, -inf)");

    m = tetrahedron();
    m.triangle[1] = {3, 1, 3};
    CHECK(fault(m) == "m: triangle 1 must have three different vertices, got 3, 1 and 3");
    m = tetrahedron();
    m.vertex[3] = {0.5, 0.5, 0};
    CHECK(fault(m) ==
          "m: triangle 3 must have an area: twice its area over the square of its longest edge must exceed "
          "1e-12, got 0");
    m.vertex[3] = m.vertex[1];  // equal points with two numbers
    CHECK(fault(m) ==
          "m: triangle 1 must have an area: twice its area over the square of its longest edge must exceed "
          "1e-12, got 0");

    m = tetrahedron();
    m.vertex.push_back({1, 1, 1});
    m.triangle.push_back({1, 4, 2});
    CHECK(fault(m) ==
          "m: triangle 4 must not be the third one at an edge: the edge of vertices 1 and 2 must have at "
          "most 2 triangles, or the mesh be two_sided, got 3");
    CHECK_NOTHROW(check_mesh(m, "m", true));
    m = tetrahedron();
    std::swap(m.triangle[3][0], m.triangle[3][1]);
    CHECK(fault(m) ==
          "m: triangle 3 must have the orientation of its neighbours: its direction along the edge of "
          "vertices 1 and 2 must be opposite to that of triangle 0, got the same");
    m = {tetrahedron().vertex, {{0, 1, 2}, {1, 2, 0}}};  // one triangle twice
    CHECK(fault(m) ==
          "m: triangle 1 must have the orientation of its neighbours: its direction along the edge of "
          "vertices 0 and 1 must be opposite to that of triangle 0, got the same");
}

TEST_CASE("check_mesh accepts open meshes, and triangles of any size and place", "[granular][mesh]")
{
    TriangleMesh m = tetrahedron();
    m.triangle.pop_back();
    CHECK(fault(m) == "nothing");
    for (const double size : {1e-310, 1e-200, 1e-9, 1e9, 1e200, 1e307}) {
        CAPTURE(size);
        CHECK(fault(image(tetrahedron(), [&](const Vec3& v) { return size * v; })) == "nothing");
    }
    // the length of an edge overflows
    m = tetrahedron();
    m.vertex[0] = {-1.5e308, 0, 0}, m.vertex[1] = {1.5e308, 0, 0};
    CHECK(fault(m).find("must have an area") != std::string::npos);
    // far from the origin, where the coordinates have 2^-27 of the size of the edges
    CHECK(fault(image(tetrahedron(), [](const Vec3& v) { return v + Vec3{67108864, 0, 0}; })) == "nothing");
    // a triangle of the relative height 1e-9 is accepted
    m = {{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {{0, 1, 2}}};
    CHECK(fault(m) == "nothing");
    m.vertex[2].y = 0.9e-12;
    CHECK(fault(m).find("got 9e-13") != std::string::npos);
    // two sides of one plate
    m = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
    CHECK(fault(m) == "nothing");
    CHECK(open_edges(m) == 0);
}

TEST_CASE("open_edges counts the edges of one triangle", "[granular][mesh]")
{
    TriangleMesh m = tetrahedron();
    CHECK(open_edges(m) == 0);
    m.triangle.pop_back();
    CHECK(open_edges(m) == 3);
    m.triangle.pop_back();
    CHECK(open_edges(m) == 4);
    m.triangle.pop_back();
    CHECK(open_edges(m) == 3);
    CHECK(open_edges({}) == 0);
    m.triangle[0][0] = 9;
    CHECK_THROWS_WITH(open_edges(m), "granular::open_edges: triangle 0 must have vertices below 4, got 9");
    CHECK_THROWS_WITH(mass_properties(m),
                      "granular::mass_properties: triangle 0 must have vertices below 4, got 9");
}

TEST_CASE("edges sorted by vertices are those of a map of edges", "[granular][mesh]")
{
    std::mt19937 random(GENERATE(1u, 2u, 3u));
    for (const std::uint32_t vertices : {4u, 7u, 40u}) {
        for (int repeat = 0; repeat < 50; ++repeat) {
            TriangleMesh m;
            const auto number = [&](std::uint32_t n) {
                return std::uniform_int_distribution<std::uint32_t>(0, n)(random);
            };
            for (std::uint32_t v = 0; v < vertices; ++v) {
                const double t = v;
                m.vertex.push_back({t, t * t, t * t * t});  // no three of them are on a line
            }
            std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<bool>> edges;
            for (std::uint32_t t = 0, n = 1 + number(vertices); t < n; ++t) {
                const std::uint32_t a = number(vertices - 1), b = number(vertices - 1),
                                    c = number(vertices - 1);
                if (a == b || b == c || c == a) continue;
                m.triangle.push_back({a, b, c});
                for (const auto& [i, j] : {std::pair(a, b), {b, c}, {c, a}})
                    edges[std::minmax(i, j)].push_back(i < j);
            }
            if (m.triangle.empty()) continue;
            std::size_t open = 0;
            bool is_good = true;
            for (const auto& [edge, rises] : edges) {
                open += rises.size() == 1;
                is_good = is_good && (rises.size() == 1 || (rises.size() == 2 && rises[0] != rises[1]));
            }
            CHECK(open_edges(m) == open);
            CHECK((fault(m) == "nothing") == is_good);
        }
    }
}

TEST_CASE("mass properties of a tetrahedron are those of the closed form", "[granular][mesh]")
{
    const MassProperties p = mass_properties(tetrahedron());
    CHECK(p.volume == Approx(1. / 6).epsilon(1e-15));
    for (const double x : {p.centre.x, p.centre.y, p.centre.z}) CHECK(x == Approx(0.25).epsilon(1e-15));
    // ∫ x² dV = 1/60, ∫ x y dV = 1/120 about the origin; V/16 less about the centre
    for (const std::size_t k : {0, 1, 2}) CHECK(p.J[k] == Approx(2. / 60 - 2. / 96).epsilon(1e-13));
    for (const std::size_t k : {3, 4, 5}) CHECK(p.J[k] == Approx(-1. / 120 + 1. / 96).epsilon(1e-13));
}

TEST_CASE("mass properties follow a motion, a scale and a reflection", "[granular][mesh]")
{
    TriangleMesh brick = tetrahedron();  // a general tetrahedron without symmetry
    brick.vertex = {{0.1, -0.2, 0.3}, {1.3, 0.2, -0.1}, {0.2, 0.9, 0.4}, {-0.1, 0.3, 1.7}};
    const MassProperties p = mass_properties(brick);

    // translation: far away the centre moves and J remains
    const Vec3 far = {1e5, -2e5, 3e5};
    const MassProperties moved = mass_properties(image(brick, [&](const Vec3& v) { return v + far; }));
    CHECK(moved.volume == Approx(p.volume).epsilon(1e-9));
    CHECK((moved.centre - far - p.centre).norm() < 1e-9);
    for (std::size_t k = 0; k < 6; ++k) CHECK(moved.J[k] == Approx(p.J[k]).margin(1e-9));

    // rotation by 90 degrees about z: x -> y, y -> -x
    const MassProperties turned = mass_properties(image(brick, [](const Vec3& v) {
        return Vec3{-v.y, v.x, v.z};
    }));
    CHECK(turned.volume == Approx(p.volume).epsilon(1e-14));
    CHECK((turned.centre - Vec3{-p.centre.y, p.centre.x, p.centre.z}).norm() < 1e-14);
    const std::array<double, 6> J = {p.J[1], p.J[0], p.J[2], -p.J[3], p.J[5], -p.J[4]};
    for (std::size_t k = 0; k < 6; ++k) CHECK(turned.J[k] == Approx(J[k]).margin(1e-14));

    // scale
    const MassProperties large = mass_properties(image(brick, [](const Vec3& v) { return 3 * v; }));
    CHECK(large.volume == Approx(27 * p.volume).epsilon(1e-14));
    CHECK((large.centre - 3 * p.centre).norm() < 1e-14);
    for (std::size_t k = 0; k < 6; ++k) CHECK(large.J[k] == Approx(243 * p.J[k]).epsilon(1e-12));

    // normals inwards: the same centre, and negative volume and inertia
    for (auto& t : brick.triangle) std::swap(t[1], t[2]);
    const MassProperties inside = mass_properties(brick);
    CHECK(inside.volume == Approx(-p.volume).epsilon(1e-14));
    CHECK((inside.centre - p.centre).norm() < 1e-14);
    for (std::size_t k = 0; k < 6; ++k) CHECK(inside.J[k] == Approx(-p.J[k]).margin(1e-14));

    // the sum over two solids that share a side, whose common side vanishes
    TriangleMesh both = tetrahedron(), other = tetrahedron();
    other.vertex = {{1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (auto& t : other.triangle) std::swap(t[1], t[2]);
    both.vertex.push_back(other.vertex[0]);
    both.triangle.pop_back();
    for (auto t : other.triangle) {
        if (t == std::array<std::uint32_t, 3>{1, 3, 2}) continue;
        for (std::uint32_t& v : t) v = v == 0 ? 4 : v;
        both.triangle.push_back(t);
    }
    CHECK(fault(both) == "nothing");
    CHECK(open_edges(both) == 0);
    const MassProperties a = mass_properties(tetrahedron()), b = mass_properties(other),
                         sum = mass_properties(both);
    CHECK(b.volume == Approx(1. / 3).epsilon(1e-14));
    CHECK(sum.volume == Approx(a.volume + b.volume).epsilon(1e-14));
    CHECK((sum.volume * sum.centre - a.volume * a.centre - b.volume * b.centre).norm() < 1e-14);

    // a mesh without a volume has finite values
    const MassProperties none = mass_properties({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}});
    CHECK(none.volume == 0);
    CHECK(std::isfinite(none.centre.x + none.centre.y + none.centre.z));
    for (const double x : none.J) CHECK(x == 0);
    CHECK(mass_properties({}).volume == 0);
}
