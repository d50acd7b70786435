// SPDX-License-Identifier: GPL-3.0-or-later
// Generated meshes: closed forms of volume, centre and inertia, closedness, and the side of the normals.
#include "granular/mesh/mesh_shapes.hpp"

#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <set>

using namespace hilda;
using namespace hilda::granular;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
const double nan_value = std::nan("");

using Polyline = std::vector<std::array<double, 2>>;

std::string refusal(const std::function<void()>& make)
{
    try {
        make();
        return "nothing";
    } catch (const io::InvalidInput& e) {
        return e.what();
    }
}

Vec3 normal(const TriangleMesh& m, std::size_t t)
{
    const auto& [a, b, c] = m.triangle[t];
    return (m.vertex[b] - m.vertex[a]).cross(m.vertex[c] - m.vertex[a]);
}

Vec3 centre(const TriangleMesh& m, std::size_t t)
{
    const auto& [a, b, c] = m.triangle[t];
    return (1. / 3) * (m.vertex[a] + m.vertex[b] + m.vertex[c]);
}

double area(const TriangleMesh& m)
{
    double sum = 0;
    for (std::size_t t = 0; t < m.triangle.size(); ++t) sum += normal(m, t).norm() / 2;
    return sum;
}

/// Checks the mesh, its number of open edges, that its vertices differ, and that all are used
void check(const TriangleMesh& m, std::size_t open = 0)
{
    check_mesh(m, "mesh");
    CHECK(open_edges(m) == open);
    std::set<std::array<double, 3>> points;
    for (const Vec3& v : m.vertex) points.insert({v.x, v.y, v.z});
    CHECK(points.size() == m.vertex.size());
    std::vector<bool> used(m.vertex.size());
    for (const auto& t : m.triangle)
        for (const std::uint32_t v : t) used[v] = true;
    CHECK(std::count(used.begin(), used.end(), false) == 0);
}

/// Order of convergence of f(n) to its limit from n = 1, 2, 4 times `first`
double order(const std::function<double(int)>& f, double limit, int first)
{
    const double coarse = std::abs(f(first) - limit), fine = std::abs(f(2 * first) - limit);
    return std::log2(coarse / fine);
}

}  // namespace

TEST_CASE("a box has the mass properties of the closed form", "[granular][mesh]")
{
    const Vec3 low = {-1, 0.5, 2}, high = {1, 2, 4.5}, d = high - low;
    const double V = d.x * d.y * d.z;
    for (const double edge : {0., -1., 0.5, 0.3, 10.}) {
        for (const bool inside : {false, true}) {
            CAPTURE(edge, inside);
            const TriangleMesh m = box_mesh(low, high, {}, inside, edge);
            check(m);
            const double sign = inside ? -1 : 1;
            const MassProperties p = mass_properties(m);
            CHECK(p.volume == Approx(sign * V).epsilon(1e-14));
            CHECK((p.centre - 0.5 * (low + high)).norm() < 1e-14);
            const std::array J = {d.y * d.y + d.z * d.z, d.z * d.z + d.x * d.x, d.x * d.x + d.y * d.y};
            for (std::size_t k = 0; k < 3; ++k) {
                CHECK(p.J[k] == Approx(sign * V / 12 * J[k]).epsilon(1e-13));
                CHECK(p.J[k + 3] == Approx(0).margin(1e-13));
            }
            const double rounding = 2e-16 * static_cast<double>(m.triangle.size());
            CHECK(area(m) == Approx(2 * (d.x * d.y + d.y * d.z + d.z * d.x)).epsilon(1e-15 + rounding));
        }
    }
    CHECK(box_mesh(low, high, {}, false, 0).vertex.size() == 8);
    CHECK(box_mesh(low, high, {}, false, 0).triangle.size() == 12);
}

TEST_CASE("open sides of a box have no triangles", "[granular][mesh]")
{
    const std::array d = {1., 1.5, 2.5};
    const std::array<std::size_t, 3> n = {2, 3, 5};
    for (unsigned sides = 0; sides < 63; ++sides) {  // all but all six
        for (const bool inside : {false, true}) {
            std::array<bool, 6> open{};
            for (std::size_t k = 0; k < 6; ++k) open[k] = (sides >> k & 1) != 0;
            const TriangleMesh m = box_mesh({0, 0, 0}, {d[0], d[1], d[2]}, open, inside, 0.5);
            // An edge of the box is open if one of its two sides is closed.
            std::size_t open_ends = 0, triangles = 0;
            for (std::size_t a = 0; a < 6; ++a) {
                const std::size_t u = (a / 2 + 1) % 3, v = (a / 2 + 2) % 3;
                if (open[a]) continue;
                triangles += 2 * n[u] * n[v];
                for (const std::size_t w : {u, v})
                    for (const std::size_t b : {2 * w, 2 * w + 1})
                        open_ends += open[b] ? n[3 - a / 2 - w] : 0;
            }
            CAPTURE(sides);
            check(m, open_ends);
            CHECK(m.triangle.size() == triangles);
            for (std::size_t t = 0; t < m.triangle.size(); ++t) {
                // the triangle is on a closed side, with the normal into the box or out of it
                const Vec3 c = centre(m, t), normal_t = normal(m, t);
                const std::array x = {c.x, c.y, c.z}, y = {normal_t.x, normal_t.y, normal_t.z};
                int found = 0;
                for (std::size_t a = 0; a < 6; ++a) {
                    const double plane = a % 2 == 1 ? d[a / 2] : 0, out = a % 2 == 1 ? 1 : -1;
                    if (x[a / 2] != plane) continue;
                    ++found;
                    REQUIRE(!open[a]);
                    REQUIRE(y[a / 2] * out * (inside ? -1 : 1) == Approx(normal_t.norm()).epsilon(1e-14));
                }
                REQUIRE(found == 1);
            }
        }
    }
}

TEST_CASE("cells have at most the demanded edge, and no more cells than necessary", "[granular][mesh]")
{
    // 0.6/0.2 and 0.3/0.1 are rounded down, 1.1 - 1 = 0.1 is rounded up
    for (const auto& [width, edge, n] : {std::tuple(0.6, 0.2, 3u),
                                         {0.3, 0.1, 3u},
                                         {1.1 - 1, 0.1, 1u},
                                         {1., 0.3, 4u},
                                         {1., 2., 1u},
                                         {1., 0., 1u},
                                         {1., -3., 1u}}) {
        CAPTURE(width, edge);
        const TriangleMesh m = plate_mesh(width, 2, edge);
        std::set<double> x;
        for (const Vec3& v : m.vertex) x.insert(v.x);
        CHECK(x.size() == n + 1);
        CHECK(*x.begin() == -width / 2);
        CHECK(*x.rbegin() == width / 2);
    }
}

TEST_CASE("a plate is a rectangle with the normal +z", "[granular][mesh]")
{
    const TriangleMesh m = plate_mesh(3, 2, 0.5);
    check(m, 2 * (6 + 4));
    CHECK(m.triangle.size() == 2 * 6 * 4);
    CHECK(m.vertex.size() == 7 * 5);
    CHECK(area(m) == Approx(6).epsilon(1e-14));
    for (std::size_t t = 0; t < m.triangle.size(); ++t) {
        CHECK(normal(m, t).x == 0);
        CHECK(normal(m, t).y == 0);
        CHECK(normal(m, t).z > 0);
    }
    check(plate_mesh(3, 2, 0), 4);
    CHECK(plate_mesh(3, 2, 0).triangle.size() == 2);
}

TEST_CASE("a sphere converges with order 2 in the edge", "[granular][mesh]")
{
    const double r = 1.5, V = 4 * pi / 3 * std::pow(r, 3), J = 0.4 * V * r * r;
    std::vector<double> volume, inertia, surface;
    for (int k = 0; k <= 6; ++k) {
        const TriangleMesh m = sphere_mesh(r, k);
        CAPTURE(k);
        check(m);
        CHECK(m.triangle.size() == std::size_t{20} << (2 * k));
        CHECK(m.vertex.size() == (std::size_t{10} << (2 * k)) + 2);
        for (const Vec3& v : m.vertex) REQUIRE(v.norm() == Approx(r).epsilon(1e-15));
        for (std::size_t t = 0; t < m.triangle.size(); ++t) REQUIRE(normal(m, t).dot(centre(m, t)) > 0);
        const MassProperties p = mass_properties(m);
        CHECK(p.centre.norm() < 1e-14);
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(p.J[i] == Approx(p.J[0]).epsilon(1e-13));  // the icosahedron is isotropic
            CHECK(p.J[i + 3] == Approx(0).margin(1e-13));
        }
        volume.push_back(p.volume), inertia.push_back(p.J[0]), surface.push_back(area(m));
    }
    // the icosahedron: V = 5/12 (3 + sqrt 5) a³ with the edge a = r / sin(2π/5)
    CHECK(volume[0] ==
          Approx(5. / 12 * (3 + std::sqrt(5)) * std::pow(r / std::sin(2 * pi / 5), 3)).epsilon(1e-14));
    const auto orders = [&](const std::vector<double>& x, double limit) {
        for (std::size_t k = 4; k < x.size(); ++k)  // the order approaches 2 from 1.96 at k = 3
            CHECK(std::log2((limit - x[k - 1]) / (limit - x[k])) == Approx(2).margin(0.03));
        CHECK(x.back() == Approx(limit).epsilon(1e-3));
    };
    orders(volume, V);
    orders(inertia, J);
    orders(surface, 4 * pi * r * r);
}

TEST_CASE("the particles of a lathe mesh are at the left of the profile", "[granular][mesh]")
{
    const auto inwards = [](const TriangleMesh& m, std::size_t t) {
        const Vec3 c = centre(m, t), n = normal(m, t);
        return -(n.x * c.x + n.y * c.y) / (n.norm() * std::hypot(c.x, c.y));
    };
    // up at radius 1: towards the axis; down: away from it
    for (const bool up : {true, false}) {
        const TriangleMesh m = up ? lathe_mesh({{1, 0}, {1, 2}}, 24) : lathe_mesh({{1, 2}, {1, 0}}, 24);
        check(m, 2 * 24);
        CHECK(m.triangle.size() == 2 * 24);
        for (std::size_t t = 0; t < m.triangle.size(); ++t) {
            CHECK(normal(m, t).z == Approx(0).margin(1e-15));
            CHECK(inwards(m, t) * (up ? 1 : -1) > 0.99);
        }
    }
    // outwards from the axis: +z; towards the axis: -z
    for (const bool out : {true, false}) {
        const TriangleMesh m = out ? lathe_mesh({{0, 3}, {2, 3}}, 7) : lathe_mesh({{2, 3}, {0, 3}}, 7);
        check(m, 7);
        CHECK(m.triangle.size() == 7);
        for (std::size_t t = 0; t < m.triangle.size(); ++t) CHECK(normal(m, t).z * (out ? 1 : -1) > 0);
    }
    // any direction: the normal is that of travel turned by +90 degrees
    for (int k = 0; k < 16; ++k) {
        const double angle = 2 * pi * (k + 0.5) / 16, c = std::cos(angle), s = std::sin(angle);
        const TriangleMesh m = lathe_mesh({{3, 0}, {3 + c, s}}, 90);
        for (std::size_t t = 0; t < m.triangle.size(); ++t) {
            const Vec3 n = normal(m, t), at = centre(m, t);
            const double radial = (n.x * at.x + n.y * at.y) / std::hypot(at.x, at.y);
            CHECK((-s * radial + c * n.z) / n.norm() > 0.999);
        }
    }
}

TEST_CASE("a lathe mesh converges to the solid of revolution with order 2", "[granular][mesh]")
{
    const double r = 0.7, h = 1.3;
    // downwards at the radius r with both ends: a cylinder with outward normals
    const Polyline profile = {{0, 1 + h}, {r, 1 + h}, {r, 1}, {0, 1}};
    const auto cylinder = [&](int n) { return mass_properties(lathe_mesh(profile, n)); };
    for (const int n : {3, 4, 5, 12, 100}) {
        // a prism over a regular polygon
        CAPTURE(n);
        const TriangleMesh m = lathe_mesh(
            n % 2 == 0 ? Polyline(profile) : Polyline{{0, 1 + h}, {r, 1 + h}, {r, 1}, {0, 1}, {0, 1 + h}}, n);
        check(m);
        CHECK(m.vertex.size() == static_cast<std::size_t>(2 * n + 2));
        CHECK(m.triangle.size() == static_cast<std::size_t>(4 * n));
        const MassProperties p = mass_properties(m);
        const double A = n / 2. * r * r * std::sin(2 * pi / n), V = A * h;
        // ∫ x² dA = ∫ y² dA = A r²/12 (2 + cos 2π/n)
        const double I = A * r * r / 12 * (2 + std::cos(2 * pi / n));
        CHECK(p.volume == Approx(V).epsilon(1e-13));
        CHECK((p.centre - Vec3{0, 0, 1 + h / 2}).norm() < 1e-13);
        CHECK(p.J[0] == Approx(I * h + V * h * h / 12).epsilon(1e-12));
        CHECK(p.J[1] == Approx(I * h + V * h * h / 12).epsilon(1e-12));
        CHECK(p.J[2] == Approx(2 * I * h).epsilon(1e-12));
        for (std::size_t k = 3; k < 6; ++k) CHECK(p.J[k] == Approx(0).margin(1e-13));
    }
    const double V = pi * r * r * h;
    CHECK(order([&](int n) { return cylinder(n).volume; }, V, 64) == Approx(2).margin(0.01));
    CHECK(order([&](int n) { return cylinder(n).J[2]; }, V * r * r / 2, 64) == Approx(2).margin(0.01));
    CHECK(cylinder(1000).volume == Approx(V).epsilon(1e-5));

    // a cone: V = π r² h / 3, centre at h/4 above its base
    const MassProperties cone = mass_properties(lathe_mesh({{0, h}, {r, 0}, {0, 0}}, 2000));
    CHECK(cone.volume == Approx(V / 3).epsilon(1e-5));
    CHECK(cone.centre.z == Approx(h / 4).epsilon(1e-12));

    // a sphere from a half circle
    const auto sphere = [&](int n) {
        Polyline half;
        for (int k = 0; k <= n; ++k)
            half.push_back({k % n == 0 ? 0 : r * std::sin(pi * k / n), r * std::cos(pi * k / n)});
        const TriangleMesh m = lathe_mesh(half, 2 * n);
        check(m);
        return mass_properties(m).volume;
    };
    CHECK(order(sphere, 4 * pi / 3 * r * r * r, 32) == Approx(2).margin(0.01));
}

TEST_CASE("a closed profile is a torus", "[granular][mesh]")
{
    const double R = 2, r = 0.5, V = 2 * pi * pi * R * r * r;
    const auto torus = [&](int n, bool outwards) {
        Polyline circle;  // clockwise: the left side is outside
        for (int k = 0; k < n; ++k) {
            const double angle = (outwards ? -2 : 2) * pi * k / n;
            circle.push_back({R + r * std::cos(angle), 1 + r * std::sin(angle)});
        }
        circle.push_back(circle.front());
        return lathe_mesh(circle, 3 * n);
    };
    for (const bool outwards : {true, false}) {
        const TriangleMesh m = torus(16, outwards);
        check(m);
        CHECK(m.vertex.size() == 16 * 48);
        CHECK(m.triangle.size() == 2 * 16 * 48);
        CHECK(mass_properties(m).volume * (outwards ? 1 : -1) > 0);
    }
    CHECK(order([&](int n) { return mass_properties(torus(n, true)).volume; }, V, 32) ==
          Approx(2).margin(0.01));
    const MassProperties p = mass_properties(torus(200, true));
    CHECK(p.volume == Approx(V).epsilon(1e-3));
    CHECK((p.centre - Vec3{0, 0, 1}).norm() < 1e-12);
    CHECK(p.J[2] == Approx(V * (R * R + 0.75 * r * r)).epsilon(1e-3));
    CHECK(p.J[0] == Approx(V * (R * R / 2 + 0.625 * r * r)).epsilon(1e-3));
}

TEST_CASE("a lathe mesh may touch the axis within its profile", "[granular][mesh]")
{
    // an hourglass of two cones with a common apex, and one with a part of the profile on the axis
    const TriangleMesh m = lathe_mesh({{0, 2}, {1, 2}, {0, 0}, {1, -2}, {0, -2}}, 12);
    check(m);
    const double A = 6 * std::sin(pi / 6);
    CHECK(mass_properties(m).volume == Approx(2 * A * 2 / 3).epsilon(1e-13));
    const TriangleMesh apart = lathe_mesh({{0, 3}, {1, 3}, {0, 1}, {0, 0}, {1, -2}, {0, -2}}, 12);
    check(apart);
    CHECK(mass_properties(apart).volume == Approx(2 * A * 2 / 3).epsilon(1e-13));
}

TEST_CASE("an extruded polygon has the area of its outline times the length", "[granular][mesh]")
{
    const auto outline_area = [](const Polyline& p) {
        double sum = 0;
        for (std::size_t k = 0; k < p.size(); ++k) {
            const auto &a = p[k], &b = p[(k + 1) % p.size()];
            sum += (a[0] * b[1] - a[1] * b[0]) / 2;
        }
        return sum;
    };
    std::vector<Polyline> all = {
        {{0, 0}, {1, 0}, {0, 1}},
        {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
        {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}},                  // L
        {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}},  // points on straight lines
        {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {0, 1}},                          // on one side of a triangle
        {{0, 0}, {0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3}, {0.7, 0.7}, {0, 1}},  // on a line within rounding
        {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 3}, {3, 3}, {3, 1}, {0, 1}},  // C
        {{0, 0}, {5, 2}, {0, 4}, {1, 2}},                                  // arrow
        {{0, 0}, {10, 0}, {10, 10}, {9, 10}, {9, 1}, {8, 1}, {8, 10}, {7, 10}, {7, 1}, {0, 1}}};
    for (const int n : {5, 60, 1000}) {  // stars and circles
        Polyline star, circle;
        for (int k = 0; k < n; ++k) {
            const double angle = 2 * pi * k / n, r = k % 2 == 0 || n % 2 == 1 ? 2 : 0.3;
            star.push_back({5 + r * std::cos(angle), r * std::sin(angle)});
            circle.push_back({std::cos(angle), std::sin(angle)});
        }
        all.push_back(star), all.push_back(circle);
    }
    Polyline comb = {{0, 0}, {80, 0}};  // teeth, and a spiral
    for (int k = 79; k >= 0; --k) comb.push_back({k + 0.5, k % 2 == 0 ? 30. : 1.});
    comb.push_back({0, 1});
    all.push_back(comb);
    Polyline spiral;
    for (int k = 0; k <= 200; ++k)
        spiral.push_back({(1 + k * 0.02) * std::cos(k * 0.1), (1 + k * 0.02) * std::sin(k * 0.1)});
    for (int k = 200; k >= 0; --k)
        spiral.push_back({(0.7 + k * 0.02) * std::cos(k * 0.1), (0.7 + k * 0.02) * std::sin(k * 0.1)});
    std::reverse(spiral.begin(), spiral.end());
    if (outline_area(spiral) < 0) std::reverse(spiral.begin(), spiral.end());
    all.push_back(spiral);

    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t shift = 0; shift < std::min<std::size_t>(all[i].size(), 4); ++shift) {
            CAPTURE(i, shift);
            Polyline& p = all[i];
            std::rotate(p.begin(), p.begin() + 1, p.end());
            const TriangleMesh m = extrude_mesh(p, 2.5);
            check(m);
            const std::size_t n = p.size();
            CHECK(m.vertex.size() == 2 * n);
            CHECK(m.triangle.size() == 2 * n + 2 * (n - 2));
            const MassProperties q = mass_properties(m);
            CHECK(q.volume == Approx(2.5 * outline_area(p)).epsilon(1e-12));
            CHECK(q.centre.z == Approx(1.25).epsilon(1e-12));
            double bottom = 0, top = 0;  // areas: the triangles of the ends neither overlap nor point inwards
            for (std::size_t t = 0; t < m.triangle.size(); ++t) {
                const Vec3 normal_t = normal(m, t);
                if (normal_t.x != 0 || normal_t.y != 0) continue;
                const bool is_top = centre(m, t).z > 1;
                REQUIRE(normal_t.z * (is_top ? 1 : -1) > 0);
                (is_top ? top : bottom) += normal_t.norm() / 2;
            }
            CHECK(bottom == Approx(outline_area(p)).epsilon(1e-12));
            CHECK(top == Approx(outline_area(p)).epsilon(1e-12));
        }
    }
}

TEST_CASE("the ends of a prism have no fans of thin triangles where others are possible", "[granular][mesh]")
{
    // A strip of squares is cut into halves of squares, whose relative area is 1/2. A fan from one of its
    // ends would have 0.02.
    Polyline strip;
    for (int k = 0; k <= 8; ++k) strip.push_back({static_cast<double>(k), 0});
    for (int k = 8; k >= 0; --k) strip.push_back({static_cast<double>(k), 1});
    const TriangleMesh m = extrude_mesh(strip, 1);
    for (std::size_t t = 2 * strip.size(); t < m.triangle.size(); ++t) {
        const auto& [a, b, c] = m.triangle[t];
        const Vec3 ab = m.vertex[b] - m.vertex[a], bc = m.vertex[c] - m.vertex[b],
                   ca = m.vertex[a] - m.vertex[c];
        CHECK(normal(m, t).norm() / std::max({ab.dot(ab), bc.dot(bc), ca.dot(ca)}) == 0.5);
    }
}

TEST_CASE("random simple polygons are triangulated, at any place, size and angle", "[granular][mesh]")
{
    std::mt19937 random(GENERATE(1u, 2u, 3u));
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int repeat = 0; repeat < 60; ++repeat) {
        const int n = 3 + static_cast<int>(number(0, 60));
        const double turn = number(0, 2 * pi), size = std::pow(10, number(-6, 6));
        const std::array<double, 2> place = {size * number(-20, 20), size * number(-20, 20)};
        Polyline p;
        for (int k = 0; k < n; ++k) {  // visible from its middle, hence simple
            const double angle = turn + 2 * pi * (k + number(0, 0.5)) / n, r = size * number(0.05, 1);
            p.push_back({place[0] + r * std::cos(angle), place[1] + r * std::sin(angle)});
        }
        if (n < 5) continue;  // the middle may be outside
        // further points on the sides, which are on a straight line within rounding only
        Polyline q;
        for (std::size_t k = 0; k < p.size(); ++k) {
            const auto &a = p[k], &b = p[(k + 1) % p.size()];
            q.push_back(a);
            for (int j = 1; j < repeat % 4; ++j) {
                const double s = j / 4.;
                q.push_back({a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])});
            }
        }
        CAPTURE(repeat, n, size);
        const TriangleMesh m = extrude_mesh(q, size);
        check(m);
        CHECK(m.triangle.size() == 2 * q.size() + 2 * (q.size() - 2));
        CHECK(mass_properties(m).volume > 0);
    }
}

TEST_CASE("invalid arguments of the shapes are refused with their value", "[granular][mesh]")
{
    const auto box = [](const Vec3& low, const Vec3& high, double edge, std::array<bool, 6> open = {}) {
        return refusal([=] { box_mesh(low, high, open, false, edge); });
    };
    CHECK(box({0, 0, nan_value}, {1, 1, 1}, 0) == "granular::box_mesh: low must be finite, got nan");
    CHECK(box({0, 0, 0}, {1, infinity, 1}, 0) == "granular::box_mesh: high must be finite, got inf");
    CHECK(box({0, 0, 0}, {1, -2, 1}, 0) ==
          "granular::box_mesh: high - low must be positive and finite, got -2");
    CHECK(box({0, 0, 0}, {1, 0, 1}, 0) ==
          "granular::box_mesh: high - low must be positive and finite, got 0");
    CHECK(box({-1.5e308, 0, 0}, {1.5e308, 1, 1}, 0) ==
          "granular::box_mesh: high - low must be positive and finite, got inf");
    CHECK(box({0, 0, 0}, {1, 1, 1}, nan_value) == "granular::box_mesh: edge must be finite, got nan");
    CHECK(box({0, 0, 0}, {1, 1, 1}, 0, {true, true, true, true, true, true}) ==
          "granular::box_mesh: a side must be closed, got 6 open sides");
    CHECK(box({0, 0, 0}, {1, 1, 1}, 1. / 1024) ==
          "granular::box_mesh: a mesh must have at most 4194304 triangles, got 12582912");
    CHECK(box({0, 0, 0}, {1, 1, 1}, 1e-310) ==
          "granular::box_mesh: a mesh must have at most 4194304 triangles, got inf");
    // the axis across the only closed side has no cells
    CHECK(box({0, 0, 0}, {1e300, 1, 1}, 0.5, {false, true, true, true, true, true}) == "nothing");

    const auto lathe = [](const Polyline& p, int n) { return refusal([=] { lathe_mesh(p, n); }); };
    CHECK(lathe({{1, 0}, {1, 1}}, 2) == "granular::lathe_mesh: segments must be at least 3, got 2");
    CHECK(lathe({{1, 0}}, 8) == "granular::lathe_mesh: the profile must have at least 2 points, got 1");
    CHECK(lathe({{1, 0}, {-0.5, 1}}, 8) ==
          "granular::lathe_mesh: the radius of point 1 of the profile must be finite and not negative, got "
          "-0.5");
    CHECK(lathe({{nan_value, 0}, {1, 1}}, 8) ==
          "granular::lathe_mesh: the radius of point 0 of the profile must be finite and not negative, got "
          "nan");
    CHECK(lathe({{1, 0}, {1, -infinity}}, 8) ==
          "granular::lathe_mesh: z of point 1 of the profile must be finite, got -inf");
    CHECK(lathe({{1, 0}, {2, 0.1}, {2, 0.1}}, 8) ==
          "granular::lathe_mesh: point 2 of the profile must differ from the one before it, got (2, 0.1) "
          "twice");
    CHECK(lathe({{1, 0}, {1, 1}, {1, 0}}, 8) ==
          "granular::lathe_mesh: a closed profile must have at least 4 points, got 3");
    CHECK(lathe({{0, 0}, {0, 1}}, 8) ==
          "granular::lathe_mesh: a radius of the profile must be positive, got 0");
    CHECK(lathe({{1, 0}, {1, 1}}, 2147483647) ==
          "granular::lathe_mesh: a mesh must have at most 4194304 triangles, got 4294967294");

    const auto extrude = [](const Polyline& p, double h) { return refusal([=] { extrude_mesh(p, h); }); };
    const Polyline square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (const auto& [h, shown] : {std::pair(0., "0"), {-1., "-1"}, {infinity, "inf"}, {nan_value, "nan"}})
        CHECK(extrude(square, h) ==
              std::string("granular::extrude_mesh: length must be positive and finite, got ") + shown);
    CHECK(extrude({{0, 0}, {1, 0}}, 1) ==
          "granular::extrude_mesh: the outline must have at least 3 points, got 2");
    CHECK(extrude(Polyline(10001), 1) ==
          "granular::extrude_mesh: the outline must have at most 10000 points, got 10001");
    CHECK(extrude({{0, 0}, {1, infinity}, {0, 1}}, 1) ==
          "granular::extrude_mesh: point 1 of the outline must be finite, got inf");
    CHECK(extrude({{0, 0}, {0, 1}, {1, 1}, {1, 0}}, 1) ==
          "granular::extrude_mesh: the outline must be counterclockwise with a finite area, got -1");
    CHECK(extrude({{0, 0}, {1, 0}, {1, 0}, {0, 1}}, 1) ==
          "granular::extrude_mesh: neighbours of the outline must differ, got equal points 1 and 2");
    CHECK(extrude({{0, 0}, {1, 0}, {0, 1}, {0, 0}}, 1) ==
          "granular::extrude_mesh: neighbours of the outline must differ, got equal points 3 and 0");
    CHECK(extrude({{0, 0}, {2, 0}, {1, 0}, {1, 1}}, 1) ==
          "granular::extrude_mesh: neighbouring sides of the outline must not overlap, got sides 0 and 1");
    CHECK(extrude({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 1) ==
          "granular::extrude_mesh: the outline must not meet itself, got common points of sides 0 and 2");
    CHECK(extrude({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, 1) ==  // touches itself
          "granular::extrude_mesh: the outline must not meet itself, got common points of sides 0 and 2");
    CHECK(extrude({{0, 0}, {1, 0}, {2, 0}}, 1) ==
          "granular::extrude_mesh: neighbouring sides of the outline must not overlap, got sides 1 and 2");
    CHECK(extrude({{0, 0}, {1, 0}, {2, 1e-15}}, 1) ==  // thinner than rounding
          "granular::extrude_mesh: the outline must be a simple polygon beyond rounding, with 1 triangles, "
          "got 0");

    const auto plate = [](double x, double y, double edge) {
        return refusal([=] { plate_mesh(x, y, edge); });
    };
    CHECK(plate(0, 1, 0) == "granular::plate_mesh: width_x must be positive and finite, got 0");
    CHECK(plate(1, -1, 0) == "granular::plate_mesh: width_y must be positive and finite, got -1");
    CHECK(plate(1, 1, infinity) == "granular::plate_mesh: edge must be finite, got inf");
    CHECK(plate(1, 1, 1. / 2048) ==
          "granular::plate_mesh: a mesh must have at most 4194304 triangles, got 8388608");

    const auto sphere = [](double r, int n) { return refusal([=] { sphere_mesh(r, n); }); };
    CHECK(sphere(0, 1) == "granular::sphere_mesh: radius must be positive and finite, got 0");
    CHECK(sphere(1, -1) == "granular::sphere_mesh: divisions must be from 0 to 8, got -1");
    CHECK(sphere(1, 9) == "granular::sphere_mesh: divisions must be from 0 to 8, got 9");
}
