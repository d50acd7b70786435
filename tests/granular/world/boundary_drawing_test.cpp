// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/boundary_drawing.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::granular;
using Shape = Boundary::Shape;

namespace boundary_drawing_test {

namespace {

const Vec3 low = {-1, -2, 0}, high = {1, 2, 3};

/// Twice the vector area of a polygon
Vec3 area(const Polygons& p, const std::vector<int>& polygon)
{
    Vec3 sum = {0, 0, 0};
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
        sum +=
            (p.point[polygon[k]] - p.point[polygon[0]]).cross(p.point[polygon[k + 1]] - p.point[polygon[0]]);
    return sum;
}

Boundary frustum_with(Boundary b, bool inside)
{
    b.inside = inside ? 1 : 0;
    return b;
}

}  // namespace

TEST_CASE("the polygons of a boundary lie on it and face the particles", "[granular][vtk]")
{
    const Vec3 tilted = (1 / 3.) * Vec3{1, 2, 2};
    const bool inside = GENERATE(false, true);
    const std::vector<Boundary> all = {
        {.shape = Shape::plane, .r = {0.1, 0.2, 0.3}, .axis = tilted},
        {.shape = Shape::cylinder, .inside = inside, .r = {0.1, 0.2, 0.3}, .axis = tilted, .radius = 0.7},
        {.shape = Shape::cone, .inside = inside, .r = {0, 0, 1}, .axis = tilted, .cosine = 0.8, .sine = 0.6},
        {.shape = Shape::sphere, .inside = inside, .r = {0.1, 0.2, 0.3}, .radius = 0.5},
        frustum_with(frustum({0.1, 0.2, 0.3}, tilted, 0.6, 0.5, 0.2), inside),
        frustum_with(frustum({0.1, 0.2, 0.3}, tilted, 0.6, 0, 0.4), inside),
        {.shape = Shape::disk, .r = {0.1, 0.2, 0.3}, .axis = tilted, .radius = 0.5},
        {.shape = Shape::torus,
         .inside = inside,
         .r = {0, 0, 1},
         .axis = tilted,
         .radius = 0.2,
         .second_radius = 0.6}};
    for (const Boundary& b : all) {
        CAPTURE(static_cast<int>(b.shape), inside);
        const Polygons drawn = drawing(b, low, high);
        REQUIRE(!drawn.polygon.empty());
        for (const Vec3& p : drawn.point)
            if ((p - b.r).norm() > 1e-9 || b.shape != Shape::cone)
                CHECK(std::abs(distance_bound(b, p)) < 1e-12);
        for (const std::vector<int>& polygon : drawn.polygon) {
            Vec3 middle = {0, 0, 0};
            for (const int k : polygon) middle += (1. / static_cast<double>(polygon.size())) * drawn.point[k];
            const Vec3 a = area(drawn, polygon);
            CHECK((a.norm() < 1e-12 || a.dot(nearest(b, middle).n) > 0.9 * a.norm()));
        }
    }
}

TEST_CASE("a plane is drawn where it intersects the domain", "[granular][vtk]")
{
    const auto size = [](const Boundary& b) {
        const Polygons drawn = drawing(b, low, high);
        double sum = 0;
        for (const std::vector<int>& polygon : drawn.polygon) sum += 0.5 * area(drawn, polygon).norm();
        return sum;
    };
    const double diagonal = std::sqrt(0.5);
    CHECK(size({.r = {5, 5, 0}, .axis = {0, 0, 1}}) == Approx(2 * 4).epsilon(1e-6));  // a side of the domain
    CHECK(size({.r = {0, 0, 1}, .axis = {0, 0, 1}}) == Approx(2 * 4).epsilon(1e-6));
    CHECK(size({.r = {0, 0, 1}, .axis = {diagonal, 0, diagonal}}) == Approx(4 * std::sqrt(8.)).epsilon(1e-6));
    CHECK(size({.r = {0, 0, -0.1}, .axis = {0, 0, 1}}) == 0);
}

}  // namespace boundary_drawing_test
