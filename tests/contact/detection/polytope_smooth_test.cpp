// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detector.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/polytope.hpp"
#include "contact/surfaces/quadric.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

#include <random>

namespace hilda::contact {

namespace {

template <class S>
Shape shape_of(S surface)
{
    return {.surface = std::make_shared<const S>(std::move(surface))};
}

struct Named {
    const char* name;
    Shape shape;
    double size;  ///< about its radius
};

std::vector<Named> polytopes()
{
    return {{"box", shape_of(Polytope::box(Vec3(0.4, 0.3, 0.2))), 0.25},
            {"rounded box", shape_of(Polytope::box(Vec3(0.4, 0.3, 0.02), 0.03)), 0.25},
            {"capsule", shape_of(Polytope::capsule(0.5, 0.1)), 0.25},
            {"polygon", shape_of(Polytope::polygon({{-0.2, -0.2}, {0.3, -0.1}, {0, 0.3}})), 0.25},
            {"convex",
             shape_of(Polytope({Vec3(0.2, 0, 0), Vec3(-0.2, 0, 0), Vec3(0, 0.3, 0), Vec3(0, -0.3, 0.1),
                                Vec3(0, 0, 0.3), Vec3(0.1, 0, -0.2)})),
             0.25}};
}

std::vector<Named> smooth_bodies()
{
    const Mat3 Q = Vec3(1 / 0.04, 1 / 0.09, 1 / 0.01).asDiagonal();
    return {{"ellipsoid", shape_of(Ellipsoid(Vec3(0.1, 0.2, 0.3))), 0.2},
            {"lens", shape_of(Ellipsoid(Vec3(0.2, 0.2, 0.02))), 0.15},
            {"needle", shape_of(Ellipsoid(Vec3(0.02, 0.02, 0.3))), 0.15},
            {"quadric away from its origin", shape_of(Quadric(Q, Vec3(-2, 3, 1), 0.2)), 0.2},
            {"round superquadric", shape_of(Superquadric(Vec3(0.1, 0.2, 0.3), 2.5)), 0.2},
            {"superquadric", shape_of(Superquadric(Vec3(0.1, 0.2, 0.15), 6, 4)), 0.2}};
}

Mat3 turned_at_random(std::mt19937& random)
{
    std::normal_distribution<double> normal;
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    return q.normalized().toRotationMatrix();
}

Vec3 random_direction(std::mt19937& random)
{
    std::normal_distribution<double> normal;
    return Vec3(normal(random), normal(random), normal(random)).normalized();
}

/// The smallest n · x of a body minus the largest of the other one
double separation(const Shape& i, const Motion& bi, const Shape& j, const Motion& bj, const Vec3& n)
{
    const auto along = [](const Shape& s, const Motion& b, const Vec3& u) {
        return u.dot(b.r + b.A * *s.surface->support(b.A.transpose() * u));
    };
    return -along(j, bj, -n) - along(i, bi, n);
}

/// The largest separation of directions all around, and of those that differ from `near` by 1 to 1e-12
double largest_separation(const Shape& i, const Motion& bi, const Shape& j, const Motion& bj,
                          const Vec3& near, std::mt19937& random)
{
    double most = -INFINITY;
    const auto take = [&](const Vec3& n) { most = std::max(most, separation(i, bi, j, bj, n)); };
    for (int k = 0; k < 3000; ++k) take(random_direction(random));
    for (double angle = 1; angle > 1e-12; angle *= 0.3)
        for (int k = 0; k < 100; ++k) take((near + angle * random_direction(random)).normalized());
    return most;
}

}  // namespace

TEST_CASE("a polytope and a smooth convex body have the largest separation of all directions (long)",
          "[contact][detection]")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const Named& i : polytopes())
        for (const Named& j : smooth_bodies()) {
            const auto detector = make_detector(i.shape, j.shape),
                       exchanged = make_detector(j.shape, i.shape);
            for (int k = 0; k < 40; ++k) {
                CAPTURE(i.name, j.name, k);
                Motion bi, bj;
                bi.A = turned_at_random(random), bj.A = turned_at_random(random);
                bj.r = Vec3(1, 2, 3);
                bi.r = bj.r + 2 * random_direction(random);
                // moved along the normal until the gap is the one wanted, then checked there
                const double wanted = k % 2 == 0 ? 0.2 * unit(random) : -1e-4 * unit(random);
                for (int step = 0; step < 30; ++step) {
                    const ContactPoint at = detector->detect(bi, bj, nullptr);
                    bi.r -= (at.gap - wanted) * at.n;
                }
                const ContactPoint at = detector->detect(bi, bj, nullptr);
                const double most = largest_separation(i.shape, bi, j.shape, bj, -at.n, random);
                CHECK(std::abs(separation(i.shape, bi, j.shape, bj, -at.n) - at.gap) < 1e-12);
                CHECK(most < at.gap + 1e-12);
                CHECK(std::abs(at.n.norm() - 1) < 1e-14);
                CHECK((at.C_i - at.C_j - at.gap * at.n).norm() < 1e-14);
                // the points are on the surfaces, with opposite normals
                const Vec3 a_i = bi.A.transpose() * (at.C_i - bi.r), a_j = bj.A.transpose() * (at.C_j - bj.r);
                CHECK(std::abs(i.shape.surface->value(a_i)) < 1e-12);
                CHECK(std::abs(j.shape.surface->value(a_j)) < 1e-9);
                CHECK((bj.A * j.shape.surface->normal(a_j) - at.n).norm() < 1e-9);

                Manifold m, other;
                detector->detect_all(bi, bj, at.gap + 1e-9, m);
                exchanged->detect_all(bj, bi, at.gap + 1e-9, other);
                REQUIRE(m.size() == 1);
                REQUIRE(other.size() == 1);
                CHECK(m[0].at.C_i == at.C_i);
                CHECK(other[0].at.C_j == at.C_i);
                CHECK(other[0].at.C_i == at.C_j);
                CHECK(other[0].at.n == -at.n);
                detector->detect_all(bi, bj, at.gap - 1e-9, m);
                CHECK(m.empty());
            }
        }
}

TEST_CASE("random poses of polytopes and smooth convex bodies have a contact point (long)",
          "[contact][detection]")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const Named& i : polytopes())
        for (const Named& j : smooth_bodies()) {
            const auto detector = make_detector(i.shape, j.shape);
            for (int k = 0; k < 1000; ++k) {
                CAPTURE(i.name, j.name, k);
                Motion bi, bj;
                bi.A = turned_at_random(random), bj.A = turned_at_random(random);
                bi.r = 1.2 * unit(random) * random_direction(random);
                const ContactPoint at = detector->detect(bi, bj, nullptr);
                CHECK(std::abs(separation(i.shape, bi, j.shape, bj, -at.n) - at.gap) < 1e-10);
                if (at.gap <= 0) continue;  // for bodies that are apart the distance is an upper bound
                const Vec3 a_i = bi.A.transpose() * (at.C_i - bi.r), a_j = bj.A.transpose() * (at.C_j - bj.r);
                CHECK(std::abs(i.shape.surface->value(a_i)) < 1e-10);
                CHECK(std::abs(j.shape.surface->value(a_j)) < 1e-9);
            }
        }
}

TEST_CASE("an ellipsoid with equal axes beside a polytope is a ball", "[contact][detection]")
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const Named& i : polytopes()) {
        const auto detector = make_detector(i.shape, shape_of(Ellipsoid(Vec3(0.1, 0.1, 0.1)))),
                   of_ball = make_detector(i.shape, shape_of(Sphere(0.1)));
        int compared = 0;
        for (int k = 0; k < 2000; ++k) {
            Motion bi, bj;
            bi.A = turned_at_random(random), bj.A = turned_at_random(random);
            bi.r = 0.4 * Vec3(unit(random), unit(random), unit(random));
            const Vec3 centre = bi.A.transpose() * (bj.r - bi.r);
            if (i.shape.surface->value(centre) < 0) continue;
            const ContactPoint at = detector->detect(bi, bj, nullptr),
                               ball = of_ball->detect(bi, bj, nullptr);
            CAPTURE(i.name, k);
            CHECK(std::abs(at.gap - ball.gap) < 1e-13);
            CHECK((at.n - ball.n).norm() < 1e-11);
            CHECK((at.C_i - ball.C_i).norm() < 1e-11);
            CHECK((at.K_j - 10 * (Mat3::Identity() - at.n * at.n.transpose())).norm() < 1e-9);
            ++compared;
        }
        CHECK(compared > 500);
    }
}

TEST_CASE("the contact point of a polytope and a smooth body is found without an allocation",
          "[contact][detection][allocation]")
{
    if (!tests::counts_allocations) return;
    const auto detector =
        make_detector(shape_of(Polytope::box(Vec3(1, 1, 0.2))), shape_of(Ellipsoid(Vec3(0.1, 0.2, 0.3))));
    Manifold m;
    std::mt19937 random(1);
    detector->detect_all({}, {.r = Vec3(0, 0, 0.4)}, 1, m);
    const long taken = tests::allocations_during([&] {
        for (int k = 0; k < 100; ++k)
            detector->detect_all({.A = turned_at_random(random)}, {.r = Vec3(0.6, 0.6, 0.3)}, 1, m);
    });
    CHECK(taken == 0);
}

TEST_CASE("a superquadric that lies flat on a face touches it without tilt", "[contact][detection]")
{
    const auto detector = make_detector(shape_of(Polytope::box(Vec3(1, 1, 0.2))),
                                        shape_of(Superquadric(Vec3(0.1, 0.2, 0.15), 8)));
    Motion bi, bj;
    bj.r = Vec3(0.1, 0.05, 0.25);
    const ContactPoint at = detector->detect(bi, bj, nullptr);
    CHECK(std::abs(at.gap) < 1e-15);
    CHECK(at.n == Vec3(0, 0, -1));
}

}  // namespace hilda::contact
