// SPDX-License-Identifier: GPL-3.0-or-later
/// Polygons of surfaces: on the surface, closed, counterclockwise from outside, as large as the scene.

#include "contact/tessellation.hpp"

#include "contact/implicit_surface.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/torus.hpp"

#include <catch2/catch.hpp>

#include <numbers>
#include <set>

using namespace hilda;
using namespace hilda::contact;

namespace {

constexpr double pi = std::numbers::pi;

/// A body without a support function: a ball with a dent at the top
struct Dented {
    template <class T>
    T operator()(const T& x, const T& y, const T& z) const
    {
        using std::exp;
        return x * x + y * y + z * z + 0.5 * exp(-8.0 * (x * x + y * y)) * z - 1.0;
    }
};

/// A wavy ground, z = 0.1 sin(3 x)
struct Waves {
    template <class T>
    T operator()(const T& x, const T& /*y*/, const T& z) const
    {
        using std::sin;
        return z - 0.1 * sin(3.0 * x);
    }
};

/// A pit without points at |x| > 1: x² + z² = 1 below the ground of a plane is an unbounded tunnel along y.
struct Tunnel {
    template <class T>
    T operator()(const T& x, const T& /*y*/, const T& z) const
    {
        return x * x + z * z - 1.0;
    }
};

Vec3 area(const PolygonMesh& mesh, const std::vector<int>& polygon)
{
    Vec3 sum = Vec3::Zero();
    const Vec3& first = mesh.point[static_cast<size_t>(polygon[0])];
    for (size_t k = 1; k + 1 < polygon.size(); ++k)
        sum += 0.5 * (mesh.point[static_cast<size_t>(polygon[k])] - first)
                         .cross(mesh.point[static_cast<size_t>(polygon[k + 1])] - first);
    return sum;
}

double volume(const PolygonMesh& mesh)
{
    double sum = 0;
    for (const auto& polygon : mesh.polygon) {
        Vec3 centre = Vec3::Zero();
        for (const int k : polygon)
            centre += mesh.point[static_cast<size_t>(k)] / static_cast<double>(polygon.size());
        sum += centre.dot(area(mesh, polygon)) / 3;
    }
    return sum;
}

/// Vertices - edges + polygons: 2 for a closed body, 0 for a torus, 1 for a patch
long characteristic(const PolygonMesh& mesh)
{
    std::set<std::pair<int, int>> edges;
    for (const auto& polygon : mesh.polygon)
        for (size_t k = 0; k < polygon.size(); ++k)
            edges.insert(std::minmax(polygon[k], polygon[(k + 1) % polygon.size()]));
    return static_cast<long>(mesh.point.size()) - static_cast<long>(edges.size()) +
           static_cast<long>(mesh.polygon.size());
}

void check_on(const Surface& surface, const PolygonMesh& mesh)
{
    REQUIRE_FALSE(mesh.polygon.empty());
    for (const Vec3& p : mesh.point) CHECK(std::abs(surface.value(p)) < 1e-9);
    for (const auto& polygon : mesh.polygon)
        for (const int k : polygon)
            CHECK(area(mesh, polygon).dot(surface.normal(mesh.point[static_cast<size_t>(k)])) > 0);
}

DrawingExtent extent(const Vec3& low, const Vec3& high)
{
    DrawingExtent e;
    e.box = Eigen::AlignedBox3d(low, high);
    e.scene_size = (high - low).norm();
    return e;
}

}  // namespace

TEST_CASE("the polygons of closed bodies have their points on the surface and nearly their volume",
          "[contact][tessellation]")
{
    const Ellipsoid ellipsoid(Vec3(1, 2, 3));
    const PolygonMesh eggs = tessellate(ellipsoid, {});
    check_on(ellipsoid, eggs);
    CHECK(characteristic(eggs) == 2);
    CHECK(volume(eggs) < 4. / 3 * pi * 6);
    CHECK(volume(eggs) ==
          Approx(4. / 3 * pi * 6).epsilon(0.08));  // the points are farther apart at the sides

    const Ellipsoid sphere(Vec3(1, 1, 1));
    const PolygonMesh globe = tessellate(sphere, {});
    check_on(sphere, globe);
    double of_frusta = 0;  // between the regular polygons of two circles of latitude
    for (int k = 0; k < down; ++k) {
        const double upper = pi * k / down, lower = pi * (k + 1) / down, r = std::sin(upper),
                     next = std::sin(lower);
        of_frusta += (std::cos(upper) - std::cos(lower)) / 3 * 12 * std::sin(2 * pi / around) *
                     (r * r + r * next + next * next);
    }
    CHECK(volume(globe) == Approx(of_frusta).epsilon(1e-12));

    const Torus torus(2, 0.5);
    const PolygonMesh ring = tessellate(torus, {});
    check_on(torus, ring);
    CHECK(characteristic(ring) == 0);
    CHECK(volume(ring) == Approx(2 * pi * 2 * pi * 0.25).epsilon(0.06));
    CHECK(volume(tessellate(Torus(2, 0.5, true), {})) == Approx(-volume(ring)));  // seen from inside

    const ImplicitSurface<Dented> dented(Dented{}, 1);
    CHECK_FALSE(dented.is_unbounded());
    const PolygonMesh ball = tessellate(dented, {});
    check_on(dented, ball);
    CHECK(characteristic(ball) == 2);
    CHECK(ball.point[0].z() < 0.85);  // the dent
    CHECK(volume(ball) == Approx(4. / 3 * pi).epsilon(0.1));
}

TEST_CASE("unbounded surfaces are drawn as large as the bodies on them", "[contact][tessellation]")
{
    const DrawingExtent scene = extent({-1, 2, 0}, {3, 4, 1});
    const Plane plane;
    const PolygonMesh ground = tessellate(plane, scene);
    check_on(plane, ground);
    CHECK(characteristic(ground) == 1);
    Eigen::AlignedBox3d drawn;
    for (const Vec3& p : ground.point) drawn.extend(p);
    CHECK((drawn.center() - Vec3(1, 3, 0)).norm() < 1e-12);
    CHECK((drawn.sizes() - Vec3(4.4, 4.4, 0)).norm() < 1e-12);  // 1.1 times the longer side
    CHECK(tessellate(plane, {}).point.front().x() == Approx(-1));

    const Cylinder pipe(0.5);
    const PolygonMesh wall = tessellate(pipe, scene);
    check_on(pipe, wall);
    CHECK(wall.point.back().z() == Approx(0.5 + 0.55));
    CHECK(tessellate(pipe, {}).point.back().z() == Approx(0.5));

    const ImplicitSurface<Waves> waves(Waves{}, 1);
    CHECK(waves.is_unbounded());
    const PolygonMesh sea = tessellate(waves, scene);
    check_on(waves, sea);
    CHECK(sea.point.size() == 81);
    for (const Vec3& p : sea.point) CHECK(p.z() == Approx(0.1 * std::sin(3 * p.x())).margin(1e-9));
}

TEST_CASE("the points of a drawing that do not exist are left out", "[contact][tessellation]")
{
    // Beside the tunnel the nearest points of the surface are drawn, if there are any.
    const ImplicitSurface<Tunnel> tunnel(Tunnel{}, 1);
    CHECK(tunnel.is_unbounded());
    const PolygonMesh mesh = tessellate(tunnel, extent({-2, -2, -1}, {2, 2, 1}));
    CHECK(mesh.point.size() <= 81);
    CHECK(mesh.point.size() > 20);
    for (const Vec3& p : mesh.point) CHECK(std::abs(tunnel.value(p)) < 1e-9);
    for (const auto& polygon : mesh.polygon)
        for (const int k : polygon) CHECK(static_cast<size_t>(k) < mesh.point.size());
}

TEST_CASE("a disk and a foot are drawn as flat pieces", "[contact][tessellation]")
{
    const PolygonMesh disk = tessellate(Disk(0.3), {});
    double whole = 0;
    for (const auto& polygon : disk.polygon) whole += area(disk, polygon).norm();
    CHECK(whole == Approx(12 * std::sin(2 * pi / 24) * 0.09));  // 24 triangles
    CHECK(characteristic(disk) == 1);

    DrawingExtent scene;
    scene.scene_size = 4;
    const PolygonMesh foot = tessellate(Foot(), scene);
    CHECK(foot.point.front().x() == Approx(-0.2));
    CHECK(foot.point.back().y() == Approx(0.2));
    CHECK(tessellate(Foot(), {}).point.back().y() == Approx(1));
}
