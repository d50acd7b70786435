// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact detection against closed forms and brute force; symmetry in the bodies i and j; objectivity.

#include "contact/detection/detector.hpp"
#include "contact/detection/common_normal.hpp"
#include "contact/implicit_surface.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "contact/surfaces/torus.hpp"
#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;
using tests::Random;

namespace {

template <class S, class... Args>
Shape shape(Args&&... args)
{
    return {.surface = std::make_shared<S>(std::forward<Args>(args)...)};
}

Shape placed(Shape s, Random& random)
{
    s.position = random.vector(0.3), s.orientation = random.rotation() * s.orientation;
    return s;
}

Shape lying(Shape s)
{
    s.orientation << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    return s;
}

Shape egg()
{
    const auto G = [](auto x, auto y, auto z) {
        return 0.5 * ((x * x + y * y) / 0.2 + z * z * (1.0 + z) / 0.3 - 0.3);
    };
    return {.surface = std::make_shared<ImplicitSurface<decltype(G)>>(G, 0.3)};
}

struct Pair {
    std::string name;
    Shape i, j;
    double distance;  ///< distance of the origins at which the bodies are close to contact
};

/// All types of pairs. Add new pairs here.
std::vector<Pair> pairs()
{
    return {
        {"sphere plane", shape<Sphere>(0.3), shape<Plane>(), 0.3},
        {"sphere sphere", shape<Sphere>(0.3), shape<Sphere>(0.2), 0.5},
        {"sphere in a bowl", shape<Sphere>(0.3), shape<Sphere>(1.0, true), 0.7},
        {"foot plane", shape<Foot>(), shape<Plane>(), 0.1},
        {"disk plane", shape<Disk>(0.4), shape<Plane>(), 0.3},
        {"ellipsoid plane", shape<Ellipsoid>(Vec3(0.3, 0.2, 0.4)), shape<Plane>(), 0.3},
        {"superquadric plane", shape<Superquadric>(Vec3(0.3, 0.2, 0.4), 3, 4), shape<Plane>(), 0.4},
        {"torus plane", shape<Torus>(0.4, 0.1), shape<Plane>(), 0.4},
        {"egg plane", egg(), shape<Plane>(), 0.3},
        {"ellipsoid sphere", shape<Ellipsoid>(Vec3(0.3, 0.2, 0.4)), shape<Sphere>(0.3), 0.6},
        {"ellipsoid ellipsoid", shape<Ellipsoid>(Vec3(0.3, 0.2, 0.4)), shape<Ellipsoid>(Vec3(0.5, 0.4, 0.3)),
         0.7},
        {"ellipsoid in a bowl", shape<Ellipsoid>(Vec3(0.3, 0.2, 0.25)), shape<Sphere>(1.0, true), 0.7},
        {"sphere in a deep bowl", shape<Sphere>(0.2), shape<Ellipsoid>(Vec3(1.0, 0.9, 0.8), true), 0.6},
        {"superquadrics", shape<Superquadric>(Vec3(0.3, 0.2, 0.4), 3, 2),
         shape<Superquadric>(Vec3(0.5, 0.4, 0.3), 2.5), 0.7},
        {"egg sphere", egg(), shape<Sphere>(0.3), 0.6},
        {"sphere cylinder", shape<Sphere>(0.3), lying(shape<Cylinder>(0.4)), 0.7},
        {"sphere in a pipe", shape<Sphere>(0.3), lying(shape<Cylinder>(1.0, true)), 0.7},
        {"cylinders", shape<Cylinder>(0.3), lying(shape<Cylinder>(0.5)), 0.8},
        {"sphere torus", shape<Sphere>(0.3), lying(shape<Torus>(0.5, 0.2)), 1.0},
    };
}

/// The shapes of a pair at random poses on two bodies. Shape i lies approximately in the direction +z of
/// shape j, at the distance of the pair ± 20 %.
struct PlacedPair {
    Shape i, j;
    Motion bi, bj;

    PlacedPair(const Pair& pair, Random& random) : i(placed(pair.i, random)), j(placed(pair.j, random))
    {
        bi.A = random.rotation(), bj.A = random.rotation();
        bj.r = random.vector();
        const Vec3 d = j.orientation * pair.j.orientation.transpose() *
                       (Vec3::UnitZ() + random.vector(0.3)).normalized();
        bi.r = bj.r + bj.A * (j.position + pair.distance * random.number(0.8, 1.2) * d) - bi.A * i.position;
    }
    ContactPoint contact_point() const { return make_detector(i, j)->detect(bi, bj, nullptr); }
};

Motion moved(const Motion& m, const Vec3& r, const Mat3& A)
{
    Motion at;
    at.r = r + A * m.r, at.A = A * m.A;
    return at;
}

constexpr double eps = 2.3e-16;

}  // namespace

TEST_CASE("the contact points lie on their surfaces along opposite normals", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const Pair& pair : pairs()) {
        INFO(pair.name);
        const PlacedPair s(pair, random);
        const ContactPoint t = s.contact_point();
        const Vec3 a_i = s.i.to_surface(s.bi.A.transpose() * (t.C_i - s.bi.r));
        const Vec3 a_j = s.j.to_surface(s.bj.A.transpose() * (t.C_j - s.bj.r));
        CHECK(std::abs(s.j.surface->value(a_j)) < 40 * eps);
        CHECK((s.bj.A * s.j.orientation * s.j.surface->normal(a_j) - t.n).norm() < 40 * eps);
        CHECK((t.C_i - t.C_j - t.gap * t.n).norm() < 20 * eps);
        CHECK(t.n.norm() == Approx(1).epsilon(10 * eps));
        CHECK((t.C() - 0.5 * (t.C_i + t.C_j)).norm() == 0);
        for (const Mat3& K : {t.K_i, t.K_j}) {
            CHECK((K - K.transpose()).norm() < 100 * eps);
            CHECK((K * t.n).norm() < 100 * eps);
        }
        if (pair.name.starts_with("foot")) {
            CHECK(a_i.norm() < 20 * eps);
        } else {
            CHECK(std::abs(s.i.surface->value(a_i)) < 40 * eps);
        }
        if (pair.name.starts_with("foot") || pair.name.starts_with("disk")) continue;
        CHECK((s.bi.A * s.i.orientation * s.i.surface->normal(a_i) + t.n).norm() < 100 * eps);
        const Mat3 axes_i = s.bi.A * s.i.orientation, axes_j = s.bj.A * s.j.orientation;
        CHECK((t.K_i - axes_i * s.i.surface->shape_operator(a_i) * axes_i.transpose()).norm() < 1e-13);
        CHECK((t.K_j - axes_j * s.j.surface->shape_operator(a_j) * axes_j.transpose()).norm() < 1e-13);
    }
}

TEST_CASE("exchanging the bodies exchanges the points and reverses the normal", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 10u)));
    for (const Pair& pair : pairs()) {
        INFO(pair.name);
        const PlacedPair s(pair, random);
        const ContactPoint t = s.contact_point(), e = make_detector(s.j, s.i)->detect(s.bj, s.bi, nullptr);
        CHECK(e.gap == t.gap);
        CHECK(e.n == -t.n);
        CHECK(e.C_i == t.C_j);
        CHECK(e.C_j == t.C_i);
        CHECK(e.K_i == t.K_j);
        CHECK(e.K_j == t.K_i);
    }
}

TEST_CASE("the contact point moves with a common rigid motion of the bodies", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 10u)));
    for (const Pair& pair : pairs()) {
        INFO(pair.name);
        const PlacedPair s(pair, random);
        const Vec3 r = random.vector();
        const Mat3 A = random.rotation();
        const ContactPoint t = s.contact_point();
        const ContactPoint m = make_detector(s.i, s.j)->detect(moved(s.bi, r, A), moved(s.bj, r, A), nullptr);
        CHECK(std::abs(m.gap - t.gap) < 1e-13);
        CHECK((m.n - A * t.n).norm() < 1e-13);
        CHECK((m.C_i - r - A * t.C_i).norm() < 1e-13);
        CHECK((m.C_j - r - A * t.C_j).norm() < 1e-13);
        CHECK((m.K_i - A * t.K_i * A.transpose()).norm() < 1e-12);
        CHECK((m.K_j - A * t.K_j * A.transpose()).norm() < 1e-12);
    }
}

TEST_CASE("detection does not allocate memory", "[contact][detection][allocation]")
{
    Random random(3);
    for (const Pair& pair : pairs()) {
        INFO(pair.name);
        const PlacedPair s(pair, random);
        const auto detector = make_detector(s.i, s.j);
        const ContactPoint t = detector->detect(s.bi, s.bj, nullptr);
        const PreviousPoints from{s.bi.A.transpose() * (t.C_i - s.bi.r),
                                  s.bj.A.transpose() * (t.C_j - s.bj.r)};
        double gap = 0;
        const long taken = tests::allocations_during([&] {
            gap = detector->detect(s.bi, s.bj, nullptr).gap + detector->detect(s.bi, s.bj, &from).gap;
        });
        CHECK(taken == 0);
        CHECK(gap == Approx(2 * t.gap).margin(1e-14));
    }
}

TEST_CASE("a ball above a plane, on it and overlapping it has the exact gap", "[contact][detection]")
{
    const auto detector = make_detector(shape<Sphere>(0.5), shape<Plane>());
    Motion ball, ground;
    for (double z : {0.75, 0.5, 0.25}) {
        ball.r = {1, 2, z};
        const ContactPoint t = detector->detect(ball, ground, nullptr);
        CHECK(t.gap == z - 0.5);
        CHECK(t.n == Vec3::UnitZ());
        CHECK(t.C_i == Vec3(1, 2, z - 0.5));
        CHECK(t.C_j == Vec3(1, 2, 0));
        CHECK(t.K_i == Mat3(Vec3(2, 2, 0).asDiagonal()));
    }
}

TEST_CASE("a ball in a bowl has its contact point at the closest wall", "[contact][detection]")
{
    const auto detector = make_detector(shape<Sphere>(0.5), shape<Sphere>(2.0, true));
    Motion ball, ground;
    ball.r = {0, 0, -1.25};
    const ContactPoint t = detector->detect(ball, ground, nullptr);
    CHECK(t.gap == 0.25);
    CHECK(t.n == Vec3::UnitZ());
    CHECK(t.C_i == Vec3(0, 0, -1.75));
    CHECK(t.C_j == Vec3(0, 0, -2));
    CHECK(t.K_i == Mat3(Vec3(2, 2, 0).asDiagonal()));
    CHECK(t.K_j == Mat3(Vec3(-0.5, -0.5, 0).asDiagonal()));
}

TEST_CASE("the contact point of an ellipsoid on a plane is its support point", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Vec3 D(0.3, 0.2, 0.5);
    const auto detector = make_detector(shape<Ellipsoid>(D), shape<Plane>());
    Motion body = random.motion(), ground;
    const ContactPoint t = detector->detect(body, ground, nullptr);
    CHECK(t.gap == Approx(body.r.z() - D.cwiseProduct(body.A.row(2).transpose()).norm()).margin(1e-15));
}

TEST_CASE("the gap of two ellipsoids is the largest of all distances between parallel tangent planes",
          "[contact][detection]")
{
    // n·(o_i - o_j) - |D_i A_iᵀ n| - |D_j A_jᵀ n| of two ellipsoids, separated (> 0) or overlapping;
    // maximised without derivatives
    Random random(GENERATE(range(0u, 20u)));
    const Vec3 D_i(0.3, 0.2, 0.4), D_j(0.5, 0.45, 0.15);
    Motion bi = random.motion(), bj = random.motion();
    bi.r = bj.r + random.number(0.5, 1.2) * random.unit();
    const auto distance = [&](const Vec3& n) {
        return n.dot(bi.r - bj.r) - D_i.cwiseProduct(bi.A.transpose() * n).norm() -
               D_j.cwiseProduct(bj.A.transpose() * n).norm();
    };
    Vec3 n = (bi.r - bj.r).normalized();
    for (double step = 0.5; step > 1e-9;) {
        const auto T = tangent_basis(n);
        Vec3 best = n;
        for (const Vec3& d : {Vec3(T.col(0)), Vec3(-T.col(0)), Vec3(T.col(1)), Vec3(-T.col(1))})
            if (const Vec3 to = (n + step * d).normalized(); distance(to) > distance(best)) best = to;
        if (best == n) step *= 0.5;
        n = best;
    }
    const ContactPoint t =
        make_detector(shape<Ellipsoid>(D_i), shape<Ellipsoid>(D_j))->detect(bi, bj, nullptr);
    CHECK(std::abs(t.gap - distance(n)) < 1e-12);
    CHECK((t.n - n).norm() < 1e-6);
}

TEST_CASE("Newton's method on the common normal converges quadratically", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 10u)));
    for (const Pair& pair : pairs()) {
        if (pair.i.surface->size() == 0 || pair.j.surface->size() == 0) continue;
        INFO(pair.name);
        const PlacedPair s(pair, random);
        const ContactPoint t = s.contact_point();
        const CommonNormal newton(s.i, s.j);
        CommonNormal::Pair p = newton.placed(s.bi, s.bj);
        p.a_i = s.i.to_surface(s.bi.A.transpose() * (t.C_i - s.bi.r)) + random.vector(0.003);
        p.a_j = s.j.to_surface(s.bj.A.transpose() * (t.C_j - s.bj.r)) + random.vector(0.003);
        double before = newton.newton_step(p);
        for (int k = 0; k < 4; ++k) {
            const double correction = newton.newton_step(p);
            CHECK(correction < 100 * before * before + 1e-13);
            before = correction;
        }
        CHECK(before < 1e-13);
    }
}

TEST_CASE("the search finds the same contact point with and without an initial guess", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const Pair& pair : pairs()) {
        INFO(pair.name);
        PlacedPair s(pair, random);
        const auto detector = make_detector(s.i, s.j);
        const ContactPoint t = detector->detect(s.bi, s.bj, nullptr);
        const PreviousPoints from{s.bi.A.transpose() * (t.C_i - s.bi.r),
                                  s.bj.A.transpose() * (t.C_j - s.bj.r)};
        s.bi.r += random.vector(1e-3), s.bi.A *= lie::exp(random.vector(1e-2));
        const ContactPoint cold = detector->detect(s.bi, s.bj, nullptr),
                           warm = detector->detect(s.bi, s.bj, &from);
        CHECK(warm.gap == Approx(cold.gap).margin(1e-14));
        CHECK((warm.C_i - cold.C_i).norm() < 1e-12);
        CHECK((warm.C_j - cold.C_j).norm() < 1e-12);
    }
}

TEST_CASE("the contact point of long and flat ellipsoids is found without an initial guess",
          "[contact][detection]")
{
    Random random(GENERATE(range(0u, 200u)));
    const auto axes = [&] {
        return Vec3(random.number(0.1, 2), random.number(0.1, 2), random.number(0.1, 2));
    };
    const Shape i = shape<Ellipsoid>(axes()), j = shape<Ellipsoid>(axes());
    Motion bi = random.motion(), bj = random.motion();
    bi.r *= 3;
    const ContactPoint t = make_detector(i, j)->detect(bi, bj, nullptr);
    CHECK((t.C_i - t.C_j - t.gap * t.n).norm() < 1e-14);
}

TEST_CASE("the contact point of a ball that rolls through a bowl is followed", "[contact][detection]")
{
    const Vec3 D(1.0, 0.8, 1.2);
    const auto detector = make_detector(shape<Sphere>(0.2), shape<Ellipsoid>(D, true));
    const Ellipsoid bowl(D);
    Motion ball, ground;
    PreviousPoints from{{0, 0, -0.2}, {0, 0, -1.2}};
    for (double angle = 0; angle < 6.3; angle += 0.1) {
        const Vec3 u(std::sin(angle) * 0.6, std::sin(angle) * 0.8, -std::cos(angle));
        const Vec3 C_j = *bowl.support(u);
        ball.r = C_j - (0.2 + 0.01) * u;
        const ContactPoint t = detector->detect(ball, ground, &from);
        CHECK(t.gap == Approx(0.01).margin(1e-14));
        CHECK((t.n + u).norm() < 1e-13);
        CHECK((t.C_j - C_j).norm() < 1e-13);
        from = {t.C_i - ball.r, t.C_j};
    }
}

TEST_CASE("a torus has the exact gap to a ball and to a plane", "[contact][detection]")
{
    Motion ring, ball, ground;
    ball.r = {1.5, 0, 0.5};
    const ContactPoint t =
        make_detector(shape<Torus>(1.0, 0.1), shape<Sphere>(0.2))->detect(ring, ball, nullptr);
    CHECK(t.gap == Approx(std::sqrt(0.5) - 0.3));
    ring.A = lie::exp({0.3, 0, 0}), ring.r.z() = 1;
    const ContactPoint low =
        make_detector(shape<Torus>(1.0, 0.1), shape<Plane>())->detect(ring, ground, nullptr);
    CHECK(low.gap == Approx(1 - std::sin(0.3) - 0.1));
}

TEST_CASE("the contact point is found if the centre of the ball lies inside the other body",
          "[contact][detection]")
{
    Random random(GENERATE(range(0u, 50u)));
    const double depth = random.number(0, 0.18);
    const Vec3 u = random.unit();
    const Torus torus(0.5, 0.2);
    const Vec3 C = *torus.support(u);
    Motion ball;
    ball.r = C - depth * u;
    const ContactPoint t =
        make_detector(shape<Sphere>(0.1), shape<Torus>(0.5, 0.2))->detect(ball, Motion(), nullptr);
    CHECK(t.gap == Approx(-depth - 0.1));
    CHECK((t.n - u).norm() < 1e-13);
    CHECK((t.C_j - C).norm() < 1e-13);
}

TEST_CASE("surfaces that do not curve away from each other have no unique contact point",
          "[contact][detection]")
{
    const auto failure = [](const Shape& i, const Shape& j, const Motion& bi, const PreviousPoints* from) {
        try {
            make_detector(i, j)->detect(bi, {}, from);
        } catch (const lie::NumericalFailure& e) {
            CHECK(e.status == "contact_not_converged");
            return std::string(e.what());
        }
        return std::string("none");
    };
    const std::string start =
        "no contact point of two surfaces: the surfaces do not curve away from each other, ";
    // the ellipsoid is flatter than the bowl at the contact point
    Motion m;
    m.r = {0, 0, -0.65};
    const PreviousPoints low{{0, 0, -0.3}, {0, 0, -1}};
    CHECK(
        failure(shape<Ellipsoid>(Vec3(0.9, 0.8, 0.3)), shape<Sphere>(1.0, true), m, &low).starts_with(start));
    // parallel axes
    m.r = {0.5, 0, 0};
    CHECK(failure(shape<Cylinder>(0.3), shape<Cylinder>(0.2), m, nullptr) ==
          "the axes of two cylinders are parallel: the contact is a line");
}

TEST_CASE("a tilted disk has the normal curvature of its rim", "[contact][detection]")
{
    const auto detector = make_detector(shape<Disk>(0.5), shape<Plane>());
    Motion disk, ground;
    for (double lean : {0.0, 0.3, 1.2, -0.7}) {
        disk.A = lie::exp(Vec3(lean + std::acos(0.0), 0, 0));
        disk.r = {0, 0, 1};
        const ContactPoint t = detector->detect(disk, ground, nullptr);
        CHECK(t.gap == Approx(1 - 0.5 * std::cos(lean)));
        CHECK((t.K_i - Vec3(std::cos(lean) / 0.5, std::cos(lean) / 0.5, 0).asDiagonal().toDenseMatrix())
                  .norm() < 1e-15);
    }
}

TEST_CASE("a disk has contact points around its rim", "[contact][detection]")
{
    const double R = 0.5;
    const Shape rim = shape<Disk>(R), plane = shape<Plane>();
    const auto detector = make_detector(rim, plane), exchanged = make_detector(plane, rim);
    for (const double tilt : {0., 1e-14, 1e-9, 1e-3, 0.5, 1.5, std::acos(0.0), 3., std::acos(-1.0)}) {
        CAPTURE(tilt);
        const Motion disk{.r = Vec3(1, 2, 0.3), .A = lie::exp(Vec3(0, 0, 0.7)) * lie::exp(Vec3(tilt, 0, 0))},
            ground;
        Manifold all, other;
        detector->detect_all(disk, ground, INFINITY, all);
        exchanged->detect_all(ground, disk, INFINITY, other);
        REQUIRE(all.size() == 8);
        REQUIRE(other.size() == 8);
        const double lowest = 0.3 - R * std::abs(std::sin(tilt));
        CHECK(std::abs(all[0].at.gap - lowest) < 1e-14);
        for (int k = 0; k < 8; ++k) {
            const ContactPoint& p = all[k].at;
            const Vec3 a = disk.A.transpose() * (p.C_i - disk.r);
            CHECK(std::abs(a.z()) < 1e-15);
            CHECK(std::abs(a.norm() - R) < 1e-15);
            CHECK(p.gap == Approx(p.C_i.z()).margin(1e-15));
            CHECK(p.gap >= lowest - 1e-14);
            CHECK((p.C_i - all[(k + 1) % 8].at.C_i).norm() == Approx(2 * R * std::sin(std::acos(0.0) / 4)));
            CHECK(all[k].feature == static_cast<std::uint32_t>(k));
            CHECK(other[k].at.C_j == p.C_i);
            CHECK(other[k].at.n == -p.n);
        }
        int within = 0;
        for (const ManifoldPoint& p : all) within += p.at.gap < 0.3 ? 1 : 0;
        detector->detect_all(disk, ground, 0.3, other);
        CHECK(other.size() == within);
    }
    // parallel to the plane the points are fixed to the body, whatever the rounding errors
    Manifold flat, noisy;
    detector->detect_all({}, {}, 1e-3, flat);
    detector->detect_all({.A = lie::exp(Vec3(3e-15, -2e-15, 0))}, {}, 1e-3, noisy);
    REQUIRE(flat.size() == 8);
    REQUIRE(noisy.size() == 8);
    for (int k = 0; k < 8; ++k) CHECK((flat[k].at.C_i - noisy[k].at.C_i).norm() < 1e-14);
}

TEST_CASE("the search restarts if the initial guess does not lead to a contact point", "[contact][detection]")
{
    Motion m, ground;
    m.r = {0, 0, 1};
    const auto detector =
        make_detector(shape<Ellipsoid>(Vec3(0.3, 0.2, 0.5)), shape<Ellipsoid>(Vec3(0.3, 0.2, 0.5)));
    const PreviousPoints far{{0, 0, 0.5}, {0, 0, -0.5}};  // on the far sides
    const ContactPoint t = detector->detect(m, ground, &far);
    CHECK(t.gap == Approx(0).margin(1e-15));
    CHECK((t.C_j - Vec3(0, 0, 0.5)).norm() < 1e-13);
}

TEST_CASE("a ball that crosses a bowl has its contact point at the closest wall", "[contact][detection]")
{
    Motion ball, ground;
    const PreviousPoints first{{-0.05, 0, 0}, {-1, 0, 0}};
    for (const Vec3& axes : {Vec3(1, 2, 2), Vec3(1, 1.2, 0.9)}) {
        const Ellipsoid bowl(axes);
        const auto detector = make_detector(shape<Sphere>(0.05), shape<Ellipsoid>(axes, true));
        PreviousPoints from = first;
        double last = 0;
        for (int k = -90; k <= 96; ++k) {
            ball.r = {0.01 * k, 0.003, 0};
            const ContactPoint t = detector->detect(ball, ground, &from);
            INFO(axes.transpose() << ", x = " << ball.r.x());
            CHECK(t.gap == Approx((ball.r - bowl.project(ball.r)).norm() - 0.05).margin(1e-12));
            if (k > -90)
                CHECK(std::abs(t.gap - last) <
                      0.0101);  // the gap changes by the displacement of the ball at most
            last = t.gap;
            from = {t.C_i - ball.r, t.C_j};
        }
        CHECK(last < 0);
        CHECK(from.c_j.x() > 0.99);
    }
}

TEST_CASE("separated bodies have a gap in every pose", "[contact][detection]")
{
    const double upright = GENERATE(0., 1e-14, 1e-11, 1e-6);
    const Shape ring = shape<Torus>(0.5, 0.1), plane = shape<Plane>();
    Motion ground, m;
    m.A = lie::exp({upright, 0, 0});
    const auto gap = [&](const Shape& i, const Shape& j, const Vec3& r) {
        m.r = r;
        const ContactPoint t = make_detector(i, j)->detect(m, ground, nullptr);
        CHECK((t.C_i - t.C_j - t.gap * t.n).norm() < 1e-8);
        CHECK(t.K_i.allFinite());
        CHECK(t.K_j.allFinite());
        const PreviousPoints from{m.A.transpose() * (t.C_i - m.r), t.C_j};
        CHECK(make_detector(i, j)->detect(m, ground, &from).gap == Approx(t.gap).margin(1e-6));
        return t.gap;
    };
    const auto about = [](double g) { return Approx(g).margin(2e-6); };
    CHECK(gap(shape<Disk>(0.3), plane, {0, 0, 1}) == about(1));
    CHECK(gap(ring, plane, {0, 0, 1}) == about(0.9));
    const double ahead = 1.3 - 0.5;  // infinite cylinders that are not parallel have a smaller gap elsewhere
    if (upright < 1e-9) CHECK(gap(shape<Cylinder>(0.3), shape<Cylinder>(0.2), {1.3, 0, 2}) == about(ahead));
    // on the axis: above a torus, in its hole, in a concave cylinder, in a concave torus
    CHECK(gap(shape<Sphere>(0.2), ring, {0, 0, 1.2}) == about(1.3 - 0.3));
    CHECK(gap(shape<Sphere>(0.2), ring, {0, 0, 0}) == about(0.2));
    CHECK(gap(shape<Sphere>(0.2), shape<Cylinder>(0.5, true), {0, 0, 1}) == about(0.3));
    CHECK(gap(shape<Sphere>(0.02), shape<Torus>(0.5, 0.1, true), {0.5, 0, 0}) == about(0.08));
    CHECK(gap(ring, ring, {0, 0, 0.7}) == about(0.5));
    CHECK(gap(ring, ring, {0, 0, 0.25}) == about(0.05));
    CHECK(gap(shape<Sphere>(0.2), shape<Ellipsoid>(Vec3(0.5, 0.5, 1), true), {0, 0, 0}) == about(0.3));
}

TEST_CASE("a pose without a unique contact point is rejected", "[contact][detection]")
{
    const auto refusal = [](const Shape& i, const Shape& j, const Vec3& r) {
        Motion m;
        m.r = r;
        try {
            make_detector(i, j)->detect(m, {}, nullptr);
        } catch (const NoUniqueContactPoint& e) {
            CHECK(e.status == "contact_not_converged");
            return std::string(e.what());
        }
        return std::string("none");
    };
    for (double sunk : {0., 1e-3}) {
        CHECK(refusal(shape<Disk>(0.3), shape<Plane>(), {0, 0, -sunk}) ==
              "a disk lies flat on a plane: the contact is the whole rim");
        CHECK(refusal(shape<Torus>(0.5, 0.1), shape<Plane>(), {0, 0, 0.1 - sunk}) ==
              "a torus lies flat on a plane: the contact is a circle");
        CHECK(refusal(shape<Cylinder>(0.3), shape<Cylinder>(0.2), {0.5 - sunk, 0, 0}) ==
              "the axes of two cylinders are parallel: the contact is a line");
    }
}

TEST_CASE("two approaching tori have the exact gap (long)", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Torus ring(0.3, 0.05);
    const auto detector = make_detector(shape<Torus>(0.3, 0.05), shape<Torus>(0.3, 0.05));
    Motion m, ground;
    m.A = random.rotation();
    const Vec3 u = random.unit();
    std::optional<PreviousPoints> from;
    for (double distance = 1.2; distance > 0.3; distance -= 0.01) {
        m.r = distance * u;
        // smallest distance of the two centre circles, by sampling one of them
        double least = INFINITY;
        for (int k = 0; k < 2000; ++k) {
            const double angle = 2 * 3.14159265358979 / 2000 * k;
            const Vec3 c = m.r + m.A * Vec3(0.3 * std::cos(angle), 0.3 * std::sin(angle), 0);
            least = std::min(least, std::hypot(std::hypot(c.x(), c.y()) - 0.3, c.z()) - 0.1);
        }
        if (least < 0.002) break;
        INFO("distance " << distance);
        const ContactPoint cold = detector->detect(m, ground, nullptr);
        const ContactPoint t = detector->detect(m, ground, from ? &*from : nullptr);
        CHECK(cold.gap > 0);
        CHECK(t.gap == Approx(least).margin(1e-4));
        from = {m.A.transpose() * (t.C_i - m.r), t.C_j};
    }
}

TEST_CASE("the principal curvatures are the eigenvalues of the shape operator", "[contact][detection]")
{
    Random random(GENERATE(range(0u, 5u)));
    const Mat3 A = random.rotation();
    const auto [least, most] =
        principal_curvatures(A * Vec3(3, -2, 0).asDiagonal() * A.transpose(), A.col(2));
    CHECK(least == Approx(-2));
    CHECK(most == Approx(3));
    ContactPoint t;
    t.n = A.col(2);
    t.K_i = A * Vec3(3, 5, 0).asDiagonal() * A.transpose();
    t.K_j = A * Vec3(-1, -4, 0).asDiagonal() * A.transpose();
    CHECK(least_curvature(t) == Approx(1));
}

TEST_CASE("pairs of surfaces without a single contact point are rejected", "[contact][detection]")
{
    const Shape plane = shape<Plane>(), foot = shape<Foot>(), disk = shape<Disk>(1.0),
                ball = shape<Sphere>(1.0), bowl = shape<Sphere>(1.0, true);
    const auto refusal = [](const Shape& i, const Shape& j) {
        try {
            make_detector(i, j);
        } catch (const lie::InvalidInput& e) {
            return std::string(e.what());
        }
        return std::string("accepted");
    };
    const std::string where = "contact::make_detector: ";
    CHECK(refusal(plane, plane) ==
          where + "a pair of surfaces must have a single contact point, got plane and plane");
    CHECK(refusal(foot, foot) == where + "a foot can be paired with a plane only, got foot and foot");
    CHECK(refusal(ball, foot) == where + "a foot can be paired with a plane only, got sphere and foot");
    CHECK(refusal(disk, ball) == where + "a disk can be paired with a plane only, got disk and sphere");
    CHECK(refusal(plane, bowl) ==
          where + "a concave surface can be in contact on its inside only, got plane and concave sphere");
    CHECK(
        refusal(bowl, bowl) ==
        where +
            "a concave surface can be in contact on its inside only, got concave sphere and concave sphere");
    CHECK(
        refusal(ball, bowl) ==
        where +
            "the radius of a sphere must be less than that of the concave sphere around it, got 1 m in 1 m");
    CHECK(refusal(shape<Cylinder>(1.0), plane) ==
          where + "a pair of surfaces must have a single contact point, got cylinder and plane");
    CHECK(refusal(shape<Cylinder>(0.5), shape<Cylinder>(1.0, true)) ==
          where +
              "a pair of surfaces must have a single contact point, got a cylinder and a concave cylinder");
    CHECK(refusal(ball, {}) == where + "a shape must have a surface, got none");

    Shape turned = ball;
    turned.orientation *= 2;
    CHECK(refusal(turned, plane).starts_with(where + "the orientation of a surface must be a rotation"));
    turned.orientation = -Mat3::Identity();
    CHECK(refusal(plane, turned) ==
          where + "the orientation of a surface must be a rotation, got a reflection");
    Shape lost = ball;
    lost.position.x() = std::nan("");
    CHECK(refusal(lost, plane) == where + "the position of a surface must be finite, got nan   0   0");
}

TEST_CASE("concentric spheres have no contact normal", "[contact][detection]")
{
    const auto detector = make_detector(shape<Sphere>(0.5), shape<Sphere>(2.0, true));
    CHECK_THROWS_AS(detector->detect({}, {}, nullptr), lie::NumericalFailure);
}
