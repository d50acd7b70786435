// SPDX-License-Identifier: GPL-3.0-or-later
// The boundaries near blocks of cells, against all boundaries.
#include "granular/core/boundary_blocks.hpp"
#include "granular/backend/split_mix.hpp"
#include "granular/core/surfaces/surfaces.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "tests/support/grains.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>

using namespace hilda;
using namespace hilda::tests;
using granular::Boundary;
using granular::BoundaryBlocks;
using granular::BoundaryBlockView;
using granular::CellGrid;

namespace {

Boundary random_boundary(granular::Random& random, Boundary::Shape shape)
{
    Boundary b;
    b.shape = shape, b.inside = random.number(0, 1) < 0.5 ? 1 : 0;
    b.r = {random.number(-0.5, 1.5), random.number(-0.5, 1.5), random.number(-0.5, 1.5)};
    b.axis = random.direction(), b.radius = random.number(0.01, 0.7);
    const double angle = random.number(0.1, 1.4);
    b.cosine = std::cos(angle), b.sine = std::sin(angle);
    if (shape == Boundary::Shape::frustum) {
        const Boundary of =
            granular::frustum(b.r, b.axis, random.number(0.05, 0.5), b.radius, 0.5 * b.radius);
        b.to = of.to, b.second_radius = of.second_radius, b.cosine = of.cosine, b.sine = of.sine;
    }
    b.second_radius = shape == Boundary::Shape::torus ? 2 * b.radius : b.second_radius;
    return b;
}

CellGrid grid(std::int32_t cells)
{
    CellGrid g;
    g.low[0] = 0.1, g.low[1] = -0.2;
    for (int k = 0; k < 3; ++k) g.cells[k] = cells + k;
    g.unit = 1. / cells / CellGrid::widest;
    return g;
}

/// The surfaces near a cell
std::vector<std::uint32_t> listed_at(const BoundaryBlockView& view, const std::array<std::int32_t, 3>& cell)
{
    std::vector<std::uint32_t> all;
    view.each(cell[0], cell[1], cell[2], [&](std::uint32_t surface) { all.push_back(surface); });
    return all;
}

bool contains(const std::vector<std::uint32_t>& ascending, std::uint32_t surface)
{
    return std::binary_search(ascending.begin(), ascending.end(), surface);
}

/// A random point in a random cell, and the surfaces near the cell
std::pair<Vec3, std::vector<std::uint32_t>> random_place(granular::Random& random, const CellGrid& g,
                                                         double width, const BoundaryBlockView& view)
{
    std::array<std::int32_t, 3> at;
    for (std::size_t k = 0; k < 3; ++k)
        at[k] = std::min(static_cast<std::int32_t>(random.number(0, g.cells[k])), g.cells[k] - 1);
    const auto inside = [&](std::size_t k) { return g.low[k] + (at[k] + random.number(0, 1)) * width; };
    const Vec3 point{inside(0), inside(1), inside(2)};
    return {point, listed_at(view, at)};
}

}  // namespace

TEST_CASE("the blocks of cells list all boundaries within reach and few others", "[granular][neighbours]")
{
    const std::int32_t cells = GENERATE(1, 9, 200);  // with 200, a block has 8 cells along each axis
    const CellGrid g = grid(cells);
    const double width = 1. / cells, reach = 0.6 * width;
    granular::Random random(5);
    std::vector<Boundary> all;
    for (const auto shape :
         {Boundary::Shape::plane, Boundary::Shape::cylinder, Boundary::Shape::cone, Boundary::Shape::sphere,
          Boundary::Shape::frustum, Boundary::Shape::disk, Boundary::Shape::torus})
        for (int k = 0; k < 20; ++k) all.push_back(random_boundary(random, shape));
    BoundaryBlocks blocks;
    REQUIRE(blocks.update(g, reach, all, {}));
    REQUIRE_FALSE(blocks.update(g, reach, all, {}));
    const BoundaryBlockView view = blocks.view();
    long missing = 0, listed = 0, far = 0;
    for (int n = 0; n < 4000; ++n) {
        const auto [point, near_cell] = random_place(random, g, width, view);
        for (std::uint32_t b = 0; b < all.size(); ++b) {
            const double distance = distance_bound(all[b], point);
            const bool is_listed = contains(near_cell, b);
            listed += is_listed;
            missing += distance < reach && !is_listed;
            far += is_listed && distance > reach + std::sqrt(3.) * 1.1 * width * (1 << view.resting.shift);
        }
    }
    CHECK(missing == 0);
    CHECK(listed > 1000);
    CHECK(far == 0);
}

TEST_CASE("the blocks of cells list all triangles within reach and few others", "[granular][mesh]")
{
    const std::int32_t cells = GENERATE(4, 30);
    const CellGrid g = grid(cells);
    const double width = 1. / cells, reach = 0.6 * width;
    granular::Random random(5);
    Boundary b;
    b.shape = Boundary::Shape::mesh, b.r = {0.5, 0.4, 0.3};
    const Vec3 a = random.direction();
    b.p = {std::cos(0.4), std::sin(0.4) * a};
    granular::Meshes meshes;
    meshes.add(granular::sphere_mesh(0.4, 2), 0, false);
    meshes.add(granular::plate_mesh(1, 2, 0.25), 1, false);
    Boundary plate = b;
    plate.r = {0.2, 0.5, 0.5};
    const std::vector<Boundary> all = {b, plate};
    BoundaryBlocks blocks;
    REQUIRE(blocks.update(g, reach, all, meshes));
    const BoundaryBlockView view = blocks.view();
    const granular::Surfaces surfaces{all.data(), meshes.view()};
    const auto triangles = static_cast<std::uint32_t>(meshes.triangle.size());
    long missing = 0, listed = 0, far = 0, near = 0;
    for (int n = 0; n < 3000; ++n) {
        const auto [point, near_cell] = random_place(random, g, width, view);
        for (std::uint32_t t = 0; t < triangles; ++t) {
            const std::uint32_t surface = granular::Surfaces::first_triangle + t;
            const double distance = (point - surfaces.closest_point(surface, point)).norm();
            const bool is_listed = contains(near_cell, surface);
            listed += is_listed, near += distance < reach;
            missing += distance < reach && !is_listed;
            far += is_listed && distance > 3 * (reach + 1.1 * width);
        }
    }
    CHECK(missing == 0);
    CHECK(near > 100);
    CHECK(50 * far < listed);
}

TEST_CASE("the blocks of cells follow boundaries that move, are added, and another grid",
          "[granular][neighbours][mesh]")
{
    granular::Random random(9);
    granular::Meshes meshes;
    meshes.add(granular::sphere_mesh(0.4, 1), 0, false);
    meshes.add(granular::plate_mesh(1, 1, 0.25), 1, false);
    std::vector<Boundary> all(5);
    all[0].shape = all[1].shape = Boundary::Shape::mesh;
    BoundaryBlocks kept;
    for (int round = 0; round < 20; ++round) {
        Boundary& b = all[static_cast<std::size_t>(round % 4)];  // the last one rests
        const Boundary moved = random_boundary(random, Boundary::Shape::sphere);
        if (b.shape == Boundary::Shape::mesh)
            b.r = moved.r;
        else
            b = moved;
        if (round % 4 == 3) all.push_back(random_boundary(random, Boundary::Shape::plane));
        if (round == 10) all.pop_back();
        const CellGrid g = grid(round < 8 ? 6 : 11);
        CHECK(kept.update(g, 0.1, all, meshes));
        CHECK_FALSE(kept.update(g, 0.1, all, meshes));
        BoundaryBlocks fresh;
        fresh.update(g, 0.1, all, meshes);
        for (std::int32_t k = 0; k < g.cells[0] * g.cells[1] * g.cells[2]; ++k) {
            const std::array cell{k % g.cells[0], k / g.cells[0] % g.cells[1], k / g.cells[0] / g.cells[1]};
            REQUIRE(listed_at(kept.view(), cell) == listed_at(fresh.view(), cell));
        }
    }
}

TEST_CASE("a boundary that moves does not touch the lists of those at rest", "[granular][neighbours]")
{
    granular::Meshes meshes;
    meshes.add(granular::plate_mesh(1, 1, 0.1), 0, false);
    std::vector<Boundary> all(2);
    all[0].shape = Boundary::Shape::mesh, all[0].r = {0.5, 0.5, 0.5};
    BoundaryBlocks blocks;
    const CellGrid g = grid(20);
    REQUIRE(blocks.update(g, 0.02, all, meshes));
    CHECK(blocks.moving.surface.empty());
    for (int k = 0; k < 3; ++k) {
        all[1].r.z += 0.05;
        const std::uint32_t* const lists = blocks.resting.surface.data();
        const std::size_t before = blocks.resting.surface.size();
        REQUIRE(blocks.update(g, 0.02, all, meshes));
        CHECK(!blocks.moving.surface.empty());
        if (k == 0) continue;  // the plane leaves the lists
        CHECK(blocks.resting.surface.data() == lists);
        CHECK(blocks.resting.surface.size() == before);
    }
}
