// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/polytope.hpp"
#include "contact/detection/detector.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

#include <catch2/catch.hpp>

#include <random>

namespace hilda::contact {

namespace {

using Wide = Eigen::Matrix<long double, 3, 1>;

std::shared_ptr<const Polytope> shared(Polytope p) { return std::make_shared<const Polytope>(std::move(p)); }

/// Random rotation, uniformly distributed
Mat3 random_rotation(std::mt19937& random)
{
    std::normal_distribution<double> normal;
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    return q.normalized().toRotationMatrix();
}

Polytope random_hull(std::mt19937& random, int points)
{
    std::normal_distribution<double> normal;
    std::vector<Vec3> p;
    for (int k = 0; k < points; ++k)
        p.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
    return Polytope(std::move(p));
}

/// The largest separation over all face normals and all cross products of edges, in long double
long double separation(const Polytope& a, const Motion& at_a, const Polytope& b, const Motion& at_b)
{
    const auto placed = [](const Polytope& p, const Motion& at) {
        std::vector<Wide> v;
        for (const Vec3& x : p.vertex)
            v.push_back(at.A.cast<long double>() * x.cast<long double>() + at.r.cast<long double>());
        return v;
    };
    const std::vector<Wide> va = placed(a, at_a), vb = placed(b, at_b);
    long double best = -1e30L;
    const auto take = [&](Wide n) {
        if (n.norm() < 1e-12L) return;
        n.normalize();
        long double most_a = -1e30L, least_a = 1e30L, most_b = -1e30L, least_b = 1e30L;
        for (const Wide& v : va) most_a = std::max(most_a, n.dot(v)), least_a = std::min(least_a, n.dot(v));
        for (const Wide& v : vb) most_b = std::max(most_b, n.dot(v)), least_b = std::min(least_b, n.dot(v));
        best = std::max({best, least_b - most_a, least_a - most_b});
    };
    const auto normal = [](const std::vector<Wide>& v, const Polytope::Face& f) -> Wide {
        const auto at = [&](std::size_t k) { return v[static_cast<std::size_t>(f.vertex[k])]; };
        return (at(1) - at(0)).cross(at(2) - at(0));
    };
    for (const auto& f : a.face) take(normal(va, f));
    for (const auto& f : b.face) take(normal(vb, f));
    const auto direction = [](const std::vector<Wide>& v, const Polytope::Edge& e) -> Wide {
        return v[static_cast<std::size_t>(e.b)] - v[static_cast<std::size_t>(e.a)];
    };
    for (const auto& e : a.edge)
        for (const auto& g : b.edge) take(direction(va, e).cross(direction(vb, g)));
    return best;
}

double least_gap(const Manifold& m)
{
    double least = INFINITY;
    for (const ManifoldPoint& p : m) least = std::min(least, p.at.gap);
    return least;
}

void check_consistent(const Manifold& m, double size)
{
    for (const ManifoldPoint& p : m) {
        CHECK(std::abs(p.at.n.norm() - 1) < 1e-14);
        CHECK((p.at.C_i - p.at.C_j - p.at.gap * p.at.n).norm() < 1e-13 * size);
    }
    for (int k = 1; k < m.size(); ++k) CHECK(m[k - 1].feature < m[k].feature);
}

}  // namespace

TEST_CASE("hulls have the faces of their bodies", "[contact][detection]")
{
    const Polytope box = Polytope::box(Vec3(1, 2, 3));
    CHECK(box.vertex.size() == 8);
    CHECK(box.face.size() == 6);
    CHECK(box.edge.size() == 12);
    CHECK(box.size() == 0.5);
    std::mt19937 random(3);
    for (int k = 0; k < 50; ++k) {
        const Polytope p = random_hull(random, 5 + k);
        CHECK(p.vertex.size() == static_cast<std::size_t>(5 + k));
        CHECK(p.vertex.size() + p.face.size() == p.edge.size() + 2);  // Euler
        for (const auto& f : p.face) {
            for (const Vec3& v : p.vertex) CHECK(f.n.dot(v) <= f.d + 1e-12);
            CHECK(f.d > -1);
        }
    }
    // a prism with faces of twelve corners, and a grid of points on its faces
    std::vector<Vec3> prism;
    for (int k = 0; k < 12; ++k)
        for (const double z : {0., 0.5, 1.})
            prism.emplace_back(std::cos(M_PI * k / 6), std::sin(M_PI * k / 6), z);
    const Polytope p(prism);
    CHECK(p.vertex.size() == 24);
    CHECK(p.face.size() == 14);
    const Polytope plate = Polytope::polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    CHECK(plate.face.size() == 2);
    CHECK(plate.edge.size() == 4);
    CHECK(plate.face[0].n == -plate.face[1].n);
}

TEST_CASE("invalid hulls are refused", "[contact][detection]")
{
    CHECK_THROWS_WITH(
        Polytope({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.1, 0.1, 0.1)}),
        Catch::Contains("vertex 4, which lies"));
    CHECK_THROWS_WITH(Polytope({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 0)}),
                      Catch::Contains("vertices 0 and 2"));
    CHECK_THROWS_WITH(Polytope({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}), Catch::Contains("on a line"));
    CHECK_THROWS_WITH(Polytope({Vec3(0, 0, NAN)}), Catch::Contains("must be finite"));
    CHECK_THROWS_WITH(Polytope({Vec3(0, 0, 0)}), Catch::Contains("needs a radius"));
    CHECK_THROWS_WITH(Polytope::box(Vec3(1, 0, 1)), Catch::Contains("must be positive"));
    CHECK_THROWS_WITH(Polytope::polygon({{0, 0}, {1, 0}, {0.1, 0.1}, {0, 1}}),
                      Catch::Contains("3 corners of 4"));
}

TEST_CASE("the surface of a polytope has the distance to it", "[contact][detection]")
{
    const Polytope p = Polytope::box(Vec3(2, 2, 2), 0.25);
    CHECK(p.value(Vec3(0, 0, 0)) == Approx(-1.25));
    CHECK(p.value(Vec3(3, 0, 0)) == Approx(1.75));
    CHECK(p.value(Vec3(2, 2, 0)) == Approx(std::sqrt(2) - 0.25));
    CHECK(p.value(Vec3(2, 2, 2)) == Approx(std::sqrt(3) - 0.25));
    for (const Vec3& a : {Vec3(3, 0.1, 0.2), Vec3(2, 2.5, 0.3), Vec3(1.5, 2, 3), Vec3(-2, 0.3, -1.7)}) {
        constexpr double d = 1e-6;
        for (int k = 0; k < 3; ++k) {
            const Vec3 e = d * Vec3::Unit(k);
            CHECK(p.gradient(a)[k] == Approx((p.value(a + e) - p.value(a - e)) / (2 * d)).margin(1e-8));
            const Vec3 column = (p.gradient(a + e) - p.gradient(a - e)) / (2 * d);
            CHECK((p.hessian(a).col(k) - column).norm() < 1e-7);
        }
        CHECK(std::abs(p.value(p.project(a))) < 1e-14);
    }
}

TEST_CASE("the depth of two polytopes is that of all separating axes, and the points lie on both (long)",
          "[contact][detection]")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    const std::vector<std::shared_ptr<const Polytope>> bodies = {
        shared(Polytope::box(Vec3(1, 1, 1))), shared(Polytope::box(Vec3(2, 0.5, 1))),
        shared(random_hull(random, 12)), shared(random_hull(random, 40))};
    int overlaps = 0;
    for (const auto& a : bodies)
        for (const auto& b : bodies) {
            const auto detector = make_detector({.surface = a}, {.surface = b}),
                       exchanged = make_detector({.surface = b}, {.surface = a});
            for (int k = 0; k < 150; ++k) {
                const Motion at_a{.r = 1.2 * Vec3(unit(random), unit(random), unit(random)),
                                  .A = random_rotation(random)},
                    at_b{.r = Vec3(0.1, 0.2, 0.3), .A = random_rotation(random)};
                const long double truth = separation(*a, at_a, *b, at_b);
                Manifold m, other;
                detector->detect_all(at_a, at_b, 1e-3, m);
                exchanged->detect_all(at_b, at_a, 1e-3, other);
                REQUIRE(m.size() == other.size());
                check_consistent(m, 1);
                for (const ManifoldPoint& q : m)  // those of the exchanged bodies, to the bit
                    CHECK(std::any_of(other.begin(), other.end(), [&](const ManifoldPoint& p) {
                        return p.at.C_i == q.at.C_j && p.at.C_j == q.at.C_i && p.at.gap == q.at.gap &&
                               p.at.n == -q.at.n;
                    }));
                if (truth > 1e-3) {
                    CHECK(m.empty());
                } else if (truth < -1e-6) {
                    ++overlaps;
                    REQUIRE_FALSE(m.empty());
                    CHECK(std::abs(least_gap(m) - static_cast<double>(truth)) < 1e-12);
                    for (const ManifoldPoint& p : m) {
                        CHECK(a->value(at_a.A.transpose() * (p.at.C_i - at_a.r)) < 1e-12);
                        CHECK(b->value(at_b.A.transpose() * (p.at.C_j - at_b.r)) < 1e-12);
                    }
                }
            }
        }
    CHECK(overlaps > 500);
}

TEST_CASE("flat on flat has four points or more, and keeps its features", "[contact][detection]")
{
    const auto box = shared(Polytope::box(Vec3(1, 1, 1)));
    const auto detector = make_detector({.surface = box}, {.surface = box});
    const Motion below;
    Manifold m, before;
    for (const double angle : {0., 0.1, 0.4, M_PI / 4}) {
        Motion above{.r = Vec3(0, 0, 1 - 1e-6),
                     .A = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix()};
        detector->detect_all(above, below, 1e-3, m);
        CHECK(m.size() == (angle == 0 ? 4 : 8));
        check_consistent(m, 1);
        for (const ManifoldPoint& p : m) {
            CHECK(p.at.n == Vec3::UnitZ());
            CHECK(p.at.gap == Approx(-1e-6).epsilon(1e-8));
        }
    }
    // shifts by rounding errors and tilts below 1e-9 do not change the features
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    detector->detect_all({.r = Vec3(0, 0, 1)}, below, 1e-3, before);
    REQUIRE(before.size() == 4);
    for (int k = 0; k < 100; ++k) {
        const Vec3 tilt = 1e-10 * Vec3(unit(random), unit(random), unit(random));
        detector->detect_all({.r = Vec3(0, 0, 1) + 1e-12 * Vec3(unit(random), unit(random), unit(random)),
                              .A = lie::exp(tilt)},
                             below, 1e-3, m);
        REQUIRE(m.size() == 4);
        for (int n = 0; n < 4; ++n) CHECK(m[n].feature == before[n].feature);
    }
    // a small box on a large one and below it: the corners of the small one
    const auto large = shared(Polytope::box(Vec3(100, 100, 1)));
    make_detector({.surface = box}, {.surface = large})->detect_all({.r = Vec3(3, -7, 1)}, below, 1e-3, m);
    CHECK(m.size() == 4);
    make_detector({.surface = large}, {.surface = box})->detect_all({.r = Vec3(3, -7, 1)}, below, 1e-3, m);
    CHECK(m.size() == 4);
    CHECK(least_gap(m) == Approx(0).margin(1e-12));
}

TEST_CASE("separated polytopes have the distance of their nearest parts", "[contact][detection]")
{
    const auto box = shared(Polytope::box(Vec3(1, 1, 1))), capsule = shared(Polytope::capsule(1, 0.1));
    const auto ball = std::make_shared<const Sphere>(0.2);
    const Motion at;
    Manifold m;
    // vertex against vertex along the diagonal
    make_detector({.surface = box}, {.surface = box})->detect_all({.r = Vec3(1.1, 1.1, 1.1)}, at, 1, m);
    REQUIRE(m.size() == 1);
    CHECK(m[0].at.gap == Approx(0.1 * std::sqrt(3)));
    CHECK((m[0].at.n - Vec3(1, 1, 1).normalized()).norm() < 1e-14);
    // ball against face, edge and vertex
    const auto ball_box = make_detector({.surface = ball}, {.surface = box});
    CHECK(ball_box->detect({.r = Vec3(0.1, 0.2, 0.8)}, at, nullptr).gap == Approx(0.1));
    CHECK(ball_box->detect({.r = Vec3(0.7, 0.2, 0.7)}, at, nullptr).gap == Approx(std::sqrt(0.08) - 0.2));
    CHECK(ball_box->detect({.r = Vec3(0.7, 0.7, 0.7)}, at, nullptr).gap == Approx(std::sqrt(0.12) - 0.2));
    CHECK(ball_box->detect({.r = Vec3(0.1, 0.2, 0.45)}, at, nullptr).gap == Approx(-0.25));
    // capsules: crossing, and parallel with two points
    const auto capsules = make_detector({.surface = capsule}, {.surface = capsule});
    const Mat3 turned = Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()).toRotationMatrix();
    CHECK(capsules->detect({.r = Vec3(0.3, 0.2, 0.1), .A = turned}, at, nullptr).gap == Approx(0.1));
    capsules->detect_all({.r = Vec3(0.25, 0, 0.4)}, at, 0.2, m);
    REQUIRE(m.size() == 2);
    CHECK(least_gap(m) == Approx(0.05));
    CHECK(std::abs(m[0].at.C_i.z() - m[1].at.C_i.z()) == Approx(0.6));
    // a capsule that lies on a box: two points; that stands on it: one
    const auto capsule_box = make_detector({.surface = capsule}, {.surface = box});
    capsule_box->detect_all({.r = Vec3(0.2, 0, 0.6), .A = turned}, at, 0.01, m);
    CHECK(m.size() == 2);
    CHECK(least_gap(m) == Approx(0).margin(1e-14));
    capsule_box->detect_all({.r = Vec3(0.2, 0, 1.1)}, at, 0.01, m);
    CHECK(m.size() == 1);
}

TEST_CASE("the nearest parts of two polytopes are among their contact points for each reach",
          "[contact][detection]")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto any = [&] { return Vec3(unit(random), unit(random), unit(random)); };
    std::vector<Vec3> hull;
    for (int k = 0; k < 6; ++k) hull.push_back(0.4 * any().normalized()), hull.push_back(-hull.back());
    const std::shared_ptr<const Surface> surfaces[] = {
        shared(Polytope::box(Vec3(1, 0.2, 0.5))), shared(Polytope::capsule(0.8, 0.1)), shared(Polytope(hull)),
        shared(Polytope::polygon({{-0.5, -0.2}, {0.5, -0.2}, {0.3, 0.4}}, 0.05)),
        std::make_shared<const Sphere>(0.2)};
    for (const auto& first : surfaces)
        for (const auto& second : surfaces) {
            const auto detector = make_detector({.surface = first}, {.surface = second});
            for (int trial = 0; trial < 200; ++trial) {
                const Motion i{.r = any(), .A = lie::exp(3 * any())}, j{.A = lie::exp(3 * any())};
                const double gap = detector->detect(i, j, nullptr).gap;
                Manifold m;
                for (const double reach : {1e-3, 0.1, 0.5}) {
                    detector->detect_all(i, j, reach, m);
                    CAPTURE(first->name(), second->name(), gap, reach);
                    REQUIRE(m.empty() == (gap >= reach));
                    if (m.empty()) continue;
                    REQUIRE(least_gap(m) == Approx(gap).margin(1e-9));
                    for (int n = 1; n < m.size(); ++n) REQUIRE(m[n - 1].feature < m[n].feature);
                }
            }
        }
}

TEST_CASE("an edge that lies in a face touches at both ends", "[contact][detection]")
{
    // the lower edge of the upper box crosses two sides of the plate below, one of them 1e-4 higher
    const auto box = shared(Polytope::box(Vec3(2, 0.5, 0.5))), plate = shared(Polytope::box(Vec3(1, 1, 0.1)));
    const auto detector = make_detector({.surface = box}, {.surface = plate});
    const Mat3 on_edge = lie::exp(Vec3(0, 1e-4, 0)) * lie::exp(Vec3(M_PI / 4, 0, 0));
    Manifold m;
    detector->detect_all({.r = Vec3(0, 0, 0.05 + std::sqrt(0.125)), .A = on_edge}, {}, 1e-3, m);
    REQUIRE(m.size() == 2);
    CHECK(std::abs(m[0].at.C_i.x() - m[1].at.C_i.x()) == Approx(1).epsilon(1e-3));
    CHECK(std::abs(m[0].at.gap - m[1].at.gap) == Approx(1e-4).epsilon(1e-3));
}

TEST_CASE("a polytope touches a plane with its vertices", "[contact][detection]")
{
    const auto box = shared(Polytope::box(Vec3(1, 2, 3)));
    const Shape plane{.surface = std::make_shared<const Plane>(), .position = Vec3(0, 0, 1)};
    const auto detector = make_detector({.surface = box}, plane);
    Manifold m;
    detector->detect_all({.r = Vec3(4, 5, 2.5 - 1e-3)}, {}, 1e-6, m);
    REQUIRE(m.size() == 4);
    for (const ManifoldPoint& p : m) {
        CHECK(p.at.gap == Approx(-1e-3));
        CHECK(p.at.C_j.z() == Approx(1));
    }
    const Mat3 tilted = Eigen::AngleAxisd(0.3, Vec3(1, 0.2, 0).normalized()).toRotationMatrix();
    const Motion at{.r = Vec3(0, 0, 3), .A = tilted};
    double lowest = INFINITY;
    for (const Vec3& v : box->vertex) lowest = std::min(lowest, (at.r + at.A * v).z() - 1);
    CHECK(detector->detect(at, {}, nullptr).gap == Approx(lowest));
    // of twelve corners eight are kept, with the deepest one
    std::vector<Vec3> prism;
    for (int k = 0; k < 12; ++k)
        for (const double z : {0., 1.}) prism.emplace_back(std::cos(M_PI * k / 6), std::sin(M_PI * k / 6), z);
    make_detector({.surface = shared(Polytope(prism))}, plane)->detect_all({.r = Vec3(0, 0, 1)}, {}, 0.1, m);
    CHECK(m.size() == 8);
    check_consistent(m, 1);
}

}  // namespace hilda::contact
