// SPDX-License-Identifier: GPL-3.0-or-later
/// All surfaces: derivatives against finite differences, curvature against closed forms, projection against
/// random points of the surface.

#include "contact/implicit_surface.hpp"
#include "contact/mesh/height_map.hpp"
#include "contact/surfaces/cone.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/paraboloid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/quadric.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "contact/surfaces/torus.hpp"
#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <numbers>

using namespace hilda;
using namespace hilda::contact;
using Eigen::Vector2d;
using tests::derivative;
using tests::Random;

namespace {

struct Ellipse {
    Vec3 D;
    template <class T>
    T operator()(const T& x, const T& y, const T& z) const
    {
        const double L = std::cbrt(D.prod());
        return 0.5 * L * (x * x / (D[0] * D[0]) + y * y / (D[1] * D[1]) + z * z / (D[2] * D[2]) - 1.0);
    }
};

/// A sphere with bumps that uses elementary functions
struct Bumps {
    template <class T>
    T operator()(const T& x, const T& y, const T& z) const
    {
        using std::sin, std::exp, std::sqrt, std::pow, std::atan2;
        return sqrt(x * x + y * y + 1.1 * z * z) + 0.05 * sin(2.0 * x) * exp(z) -
               0.03 * atan2(y, 4.0 + x) / (4.0 + y) + 0.02 * pow(4.0 + z, 1.7) - 1.2;
    }
};

/// A symmetric matrix with these eigenvalues and general axes
Mat3 askew(double a, double b, double c)
{
    const Mat3 A = lie::exp(Vec3(0.4, -0.7, 0.5)), Q = A * Vec3(a, b, c).asDiagonal() * A.transpose();
    return 0.5 * (Q + Q.transpose());
}

double cubic(double x, double y)
{
    return 0.2 + 0.1 * x - 0.03 * x * x + 0.02 * x * y - 1e-3 * x * y * y * y;
}

using Surfaces = std::vector<std::pair<std::string, std::unique_ptr<Surface>>>;

/// All types of surfaces, convex and concave. Add new surfaces here.
Surfaces surfaces()
{
    Surfaces all;
    const auto add = [&](const std::string& name, auto surface) {
        all.emplace_back(name, std::make_unique<decltype(surface)>(std::move(surface)));
    };
    const Vec3 D(0.9, 0.7, 1.2);
    add("plane", Plane());
    add("foot", Foot());
    add("disk", Disk(0.8));
    add("sphere", Sphere(0.8));
    add("bowl", Sphere(0.8, true));
    add("ellipsoid", Ellipsoid(D));
    add("hollow ellipsoid", Ellipsoid(D, true));
    add("cylinder", Cylinder(0.8));
    add("pipe", Cylinder(0.8, true));
    add("torus", Torus(1.3, 0.6));
    add("hollow torus", Torus(1.3, 0.6, true));
    add("paraboloid", Paraboloid(0.9, 0.7));
    add("dish", Paraboloid(1.1, 1.2, true));
    add("cone", Cone(0.5));
    add("funnel", Cone(1.0, true));
    add("ellipsoid askew", Quadric(askew(1, 2, 0.7), Vec3(0.1, -0.2, 0.3), -0.8));
    add("hyperboloid", Quadric(askew(1, 1.5, -0.4), Vec3(0.1, 0, 0.2), -0.6));
    add("saddle", Quadric(askew(0.8, -0.5, 0), Vec3(0.3, 0.4, -0.5), 0.1, true));
    add("height map", HeightMap::sampled(cubic, Vector2d(-8, -9), Vector2d(9, 8), 9, 12));
    add("superquadric 2", Superquadric(D, 2));
    add("superquadric 5.5", Superquadric(D, 5.5));
    add("superquadric 2 6", Superquadric(D, 2, 6));
    add("implicit ellipsoid", ImplicitSurface(Ellipse{D}, 0.9));
    add("bumps", ImplicitSurface(Bumps{}, 1.0, true));
    return all;
}

/// A random point at a distance; for a cone only points whose closest point is not the apex
Vec3 somewhere(const Surface& surface, double distance, Random& random)
{
    const bool pointed = dynamic_cast<const Cone*>(&surface) != nullptr;
    return distance * (random.unit() + (pointed ? 1.5 : 0) * Vec3::UnitZ());
}

/// A random point on the surface
Vec3 point_on(const Surface& surface, Random& random)
{
    return surface.project(somewhere(surface, 1.5, random));
}

/// The derivatives of f with respect to the coordinates of a, as columns
template <class F>
Mat3 derivatives(const F& f, const Vec3& a)
{
    Mat3 all;
    for (int k = 0; k < 3; ++k)
        all.col(k) = derivative([&](double tau) { return Vec3(f(Vec3(a + tau * Vec3::Unit(k)))); }, 5e-4);
    return all;
}

}  // namespace

TEST_CASE("the derivatives of a surface agree with finite differences", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const auto& surface : surfaces()) {
        INFO(surface.first);
        const auto& s = surface.second;
        const Vec3 a = point_on(*s, random) + random.vector(0.05);
        Vec3 gradient;
        for (int k = 0; k < 3; ++k)
            gradient[k] = derivative([&](double tau) { return s->value(a + tau * Vec3::Unit(k)); }, 5e-4);
        constexpr double difference = 2e-9;
        CHECK((s->gradient(a) - gradient).norm() < difference * gradient.norm());

        const Mat3 H = s->hessian(a);
        CHECK((H - derivatives([&](const Vec3& x) { return s->gradient(x); }, a)).norm() <=
              difference * H.norm());
        CHECK(H == H.transpose());

        const Mat3 dn = s->normal_derivative(a);
        CHECK((dn - derivatives([&](const Vec3& x) { return s->normal(x); }, a)).norm() <=
              difference * (1 + dn.norm()));

        const auto [G, same_gradient, same_hessian] = s->derivatives(a);
        CHECK(G == s->value(a));
        CHECK(same_gradient == s->gradient(a));
        CHECK(same_hessian == H);
    }
}

TEST_CASE("the shape operator is symmetric and equals the derivative of the normal on tangent vectors",
          "[contact][surface]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const auto& [name, s] : surfaces()) {
        INFO(name);
        const Vec3 a = point_on(*s, random), n = s->normal(a);
        const Mat3 K = s->shape_operator(a), dn = s->normal_derivative(a);
        constexpr double round_off = 1e-14;
        CHECK((K - K.transpose()).norm() <= round_off * K.norm());
        CHECK((K * n).norm() <= round_off * K.norm());
        const Eigen::Matrix<double, 3, 2> T = tangent_basis(n);
        CHECK((K * T - dn * T).norm() <= round_off * dn.norm());
        const Vec3 t = T.col(0);
        CHECK(s->normal_curvature(a, t) == Approx(t.dot(dn * t)).margin(round_off));
        CHECK(s->mean_curvature(a) == Approx(0.5 * (T.transpose() * dn * T).trace()).margin(round_off));
    }
}

TEST_CASE("the gradient of a surface has a norm of about 1", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const auto& [name, s] : surfaces()) {
        INFO(name);
        const double g = s->gradient(point_on(*s, random)).norm();
        CHECK(g > 0.15);
        CHECK(g < 3);
    }
}

TEST_CASE("Gaussian, mean and normal curvatures agree with closed forms", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 20u)));
    const auto gauss = [](const Mat3& K) { return 0.5 * (K.trace() * K.trace() - (K * K).trace()); };

    const Vec3 D(0.9, 0.7, 1.2);
    for (const bool concave : {false, true}) {
        const Ellipsoid ellipsoid(D, concave);
        const Vec3 a = *ellipsoid.support(random.unit());
        const double p = 1 / a.cwiseQuotient(D.cwiseAbs2()).norm(), abc = D.prod(), sign = concave ? -1 : 1;
        CHECK(gauss(ellipsoid.shape_operator(a)) == Approx(std::pow(p, 4) / (abc * abc)).epsilon(1e-13));
        CHECK(ellipsoid.mean_curvature(a) ==
              Approx(sign * std::pow(p, 3) * (D.squaredNorm() - a.squaredNorm()) / (2 * abc * abc))
                  .epsilon(1e-13));
    }

    const double R = 1.3, r = 0.4, phi = random.number(-3, 3), at = random.number(-3, 3),
                 rho = R + r * std::cos(phi);
    const Torus torus(R, r);
    const Vec3 a(rho * std::cos(at), rho * std::sin(at), r * std::sin(phi));
    CHECK(gauss(torus.shape_operator(a)) == Approx(std::cos(phi) / (r * rho)).epsilon(1e-12).margin(1e-14));
    CHECK(torus.mean_curvature(a) == Approx(0.5 * (1 / r + std::cos(phi) / rho)).epsilon(1e-13));

    const Vec3 in_dish = random.vector(2);
    const double R_x = 1.1, R_y = 0.6, x = in_dish.x(), y = in_dish.y();
    const double steep = 1 + x * x / (R_x * R_x) + y * y / (R_y * R_y);
    const Vec3 on_dish(x, y, 0.5 * (x * x / R_x + y * y / R_y));
    for (const bool concave : {false, true}) {
        const Paraboloid dish(R_x, R_y, concave);
        const double sign = concave ? -1 : 1;
        CHECK(gauss(dish.shape_operator(on_dish)) == Approx(1 / (R_x * R_y * steep * steep)).epsilon(1e-12));
        CHECK(dish.mean_curvature(on_dish) ==
              Approx(sign * 0.5 * ((1 + y * y / (R_y * R_y)) / R_x + (1 + x * x / (R_x * R_x)) / R_y) /
                     std::pow(steep, 1.5))
                  .epsilon(1e-13));
    }

    const double beta = random.number(0.1, 1.4), along = random.number(0.1, 3);
    const Cone cone(beta);
    const Vec3 side(std::sin(beta) * std::cos(at), std::sin(beta) * std::sin(at), std::cos(beta));
    const Vec3 around(-std::sin(at), std::cos(at), 0), on_cone = along * side;
    CHECK(std::abs(cone.value(on_cone)) < 1e-15 * along);
    CHECK(cone.normal_curvature(on_cone, side) == Approx(0).margin(1e-13));
    CHECK(cone.normal_curvature(on_cone, around) == Approx(1 / (along * std::tan(beta))).epsilon(1e-13));

    const Cylinder pipe(0.5, true);
    const Vec3 on_pipe = pipe.project(random.vector());
    CHECK(pipe.normal_curvature(on_pipe, Vec3::UnitZ()) == 0);
    CHECK(pipe.mean_curvature(on_pipe) == Approx(-1));
    CHECK(Disk(0.5).normal_curvature({0.3, 0.4, 0}, Vec3(-0.8, 0.6, 0)) == Approx(2));
}

TEST_CASE("a quadric agrees with the ellipsoid, the paraboloid and the cylinder of the same equation",
          "[contact][surface]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Vec3 D(0.9, 0.7, 1.2), o = random.vector();
    const Mat3 A = random.rotation();
    const double factor = std::exp(random.number(-3, 3));
    /// The quadric with the coefficients of G after a displacement by o and a rotation by A
    const auto moved = [&](const Mat3& Q_0, const Vec3& b_0, double c_0) {
        Mat3 Q = A * Q_0 * A.transpose();
        Q = 0.5 * (Q + Q.transpose()).eval();
        const Vec3 b = A * b_0 - Q * o;
        return Quadric(factor * Q, factor * b, factor * (c_0 - b.dot(o) - (A * b_0).dot(o)));
    };
    const auto same = [&](const Surface& quadric, const Surface& own, double size) {
        CHECK(quadric.size() == Approx(size).epsilon(1e-12));
        const Vec3 a = own.project(1.5 * random.unit()), there = o + A * a;
        CHECK(std::abs(quadric.value(there)) < 3e-14);
        CHECK((quadric.normal(there) - A * own.normal(a)).norm() < 1e-13);
        CHECK((quadric.shape_operator(there) - A * own.shape_operator(a) * A.transpose()).norm() < 1e-12);
    };
    const Quadric ellipsoid = moved(D.cwiseAbs2().cwiseInverse().asDiagonal(), Vec3::Zero(), -1);
    same(ellipsoid, Ellipsoid(D), D.minCoeff());
    CHECK(ellipsoid.convex());
    const Vec3 u = random.unit();
    CHECK((*ellipsoid.support(A * u) - o - A * *Ellipsoid(D).support(u)).norm() < 1e-13);
    const Quadric dish = moved(Vec3(1 / 1.1, 1 / 0.6, 0).asDiagonal(), Vec3(0, 0, -1), 0);
    same(dish, Paraboloid(1.1, 0.6), 0.6);
    CHECK_FALSE(dish.convex());
    same(moved(Vec3(1, 1, 0).asDiagonal(), Vec3::Zero(), -0.25), Cylinder(0.5), 0.5);
}

TEST_CASE("the projection of points inside a paraboloid is the closest point", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Vec3 inside(random.number(-0.5, 0.5), random.number(-0.5, 0.5), random.number(1, 3));
    for (const auto& [R_x, R_y] : {std::pair(0.9, 0.7), std::pair(0.6, 0.8), std::pair(0.5, 0.5)}) {
        const Paraboloid s(R_x, R_y);
        // on the axis and the planes of symmetry, and so close to them that squares underflow
        for (const Vec3& mask : {Vec3(1, 1, 1), Vec3(1, 0, 1), Vec3(0, 1, 1), Vec3(0, 0, 1), Vec3(1, 0, 0.1),
                                 Vec3(0, 0, 0), Vec3(1e-200, 1e-12, 1), Vec3(1e-9, 1e-200, 1)}) {
            const Vec3 a = inside.cwiseProduct(mask), x = s.project(a);
            INFO(a.transpose() << " in " << R_x << " " << R_y);
            CHECK(std::abs(s.value(x)) < 1e-14);
            for (int k = 0; k < 100; ++k) {
                const double u = random.number(-3, 3), v = random.number(-3, 3);
                CHECK((Vec3(u, v, s.value({u, v, 0})) - a).norm() >= (x - a).norm() - 1e-14);
            }
        }
    }
}

TEST_CASE("a superquadric is an ellipsoid for exponents of 2 and has flat points for larger exponents",
          "[contact][surface]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Vec3 D(0.9, 0.7, 1.2), u = random.unit();
    const Ellipsoid ellipsoid(D);
    const Superquadric same(D, 2), box(D, 4), can(D, 2, 8);
    const Vec3 a = *ellipsoid.support(u);
    CHECK((*same.support(u) - a).norm() < 1e-14);
    CHECK(same.value(a) == Approx(ellipsoid.value(a)).margin(1e-15));
    CHECK((same.gradient(a) - ellipsoid.gradient(a)).norm() < 1e-14);
    CHECK((same.hessian(a) - ellipsoid.hessian(a)).norm() < 1e-14);

    for (int k = 0; k < 3; ++k) CHECK(box.shape_operator(D[k] * Vec3::Unit(k)).norm() == 0);
    const Mat3 K = can.shape_operator({D.x(), 0, 0});
    CHECK((K - Vec3(0, D.x() / (D.y() * D.y()), 0).asDiagonal().toDenseMatrix()).norm() < 1e-14);
}

TEST_CASE("the gradient at the support point has the given direction", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const auto& [name, s] : surfaces()) {
        INFO(name);
        const Vec3 u = random.unit();
        const std::optional<Vec3> a = s->support(u);
        CHECK(a.has_value() >= s->convex());
        if (!a) continue;
        CHECK(std::abs(s->value(*a)) < 1e-14);
        CHECK((s->gradient(*a).normalized() - u).norm() < 1e-13);
        for (int k = 0; k < 100; ++k) CHECK(point_on(*s, random).dot(u) <= a->dot(u) + 1e-14);
    }
    CHECK_THROWS_AS(Torus(1, 0.2).support(Vec3::UnitZ()), lie::NumericalFailure);
}

TEST_CASE("the projection onto a surface is its closest point", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 20u)));
    for (const auto& [name, s] : surfaces()) {
        if (name == "disk") continue;  // a disk projects onto its rim, not onto G = 0
        INFO(name);
        const Vec3 outside = somewhere(*s, 2.5, random), near = point_on(*s, random) + random.vector(0.1);
        for (const Vec3& a : {outside, near}) {
            const Vec3 x = s->project(a);
            CHECK(std::abs(s->value(x)) < 1e-14);
            CHECK((a - x).cross(s->normal(x)).norm() < 3e-14);
            for (int k = 0; k < 100; ++k) CHECK((point_on(*s, random) - a).norm() >= (x - a).norm() - 1e-14);
        }
    }
}

TEST_CASE("the projection of points inside an ellipsoid is the closest point", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 10u)));
    for (const Vec3& D : {Vec3(0.9, 0.7, 1.2), Vec3(0.5, 0.5, 1.0), Vec3(1, 0.4, 1), Vec3(0.8, 0.8, 0.8)}) {
        const Ellipsoid s(D);
        const Vec3 inside = D.cwiseProduct(random.vector(0.5));
        // on the planes and the axes of symmetry, and so close to them that squares underflow
        for (const Vec3& mask :
             {Vec3(1, 1, 1), Vec3(1, 1, 0), Vec3(0, 1, 1), Vec3(1, 0, 1), Vec3(0, 0, 1), Vec3(0, 1, 0),
              Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(1e-200, 1e-12, 1), Vec3(1, 1e-9, 1e-200)}) {
            const Vec3 a = inside.cwiseProduct(mask), x = s.project(a);
            INFO(a.transpose() << " in " << D.transpose());
            CHECK(std::abs(s.value(x)) < 1e-14);
            for (int k = 0; k < 100; ++k)
                CHECK((*s.support(random.unit()) - a).norm() >= (x - a).norm() - 1e-14);
        }
    }
}

TEST_CASE("a disk projects onto its rim", "[contact][surface]")
{
    CHECK((Disk(0.5).project({3, 4, 2}) - Vec3(0.3, 0.4, 0)).norm() < 1e-15);
    CHECK_THROWS_AS(Disk(0.5).project({0, 0, 1}), lie::NumericalFailure);
}

TEST_CASE("arc is the length along the circle for spheres and disks", "[contact][surface]")
{
    const double angle = GENERATE(1e-9, 0.3, 2.0, std::numbers::pi);
    const double chord = 2 * 0.8 * std::sin(angle / 2);
    CHECK(Sphere(0.8).arc(chord) == Approx(0.8 * angle).epsilon(1e-14));
    CHECK(Disk(0.8).arc(chord) == Approx(0.8 * angle).epsilon(1e-14));
    CHECK(Sphere(0.8).arc(1.7) == Approx(0.8 * std::numbers::pi));
    CHECK(Plane().arc(chord) == chord);
}

TEST_CASE("a tangent basis is orthonormal and right-handed for every normal", "[contact][surface]")
{
    Random random(5);
    std::vector<Vec3> normals = {Vec3::UnitX(), Vec3::UnitZ(), -Vec3::UnitZ(), Vec3(1, 0, -1e-300),
                                 Vec3(1e-9, 0, -1)};
    for (int k = 0; k < 100; ++k) normals.push_back(random.unit());
    for (const Vec3& n : normals) {
        Mat3 A;
        A << tangent_basis(n), n;
        CHECK(lie::orthogonality_error(A) < 2e-15);
        CHECK(A.determinant() == Approx(1));
    }
}

TEST_CASE("surfaces with invalid dimensions are rejected", "[contact][surface]")
{
    const auto refusal = [](auto make) {
        try {
            make();
        } catch (const lie::InvalidInput& e) {
            return std::string(e.what());
        }
        return std::string("accepted");
    };
    const double nan = std::nan("");
    CHECK(refusal([] { Sphere(-0.2); }) ==
          "contact::Sphere: the radius of a sphere must be positive and finite, got -0.2");
    CHECK(refusal([] { Sphere{INFINITY}; }) ==
          "contact::Sphere: the radius of a sphere must be positive and finite, got inf");
    CHECK(refusal([&] { Disk{nan}; }) ==
          "contact::Disk: the radius of a disk must be positive and finite, got nan");
    CHECK(refusal([] { Cylinder(0); }) ==
          "contact::Cylinder: the radius of a cylinder must be positive and finite, got 0");
    CHECK(refusal([] {
              Ellipsoid({1, 2, 0});
          }) == "contact::Ellipsoid: a semi-axis of an ellipsoid must be positive and finite, got 0");
    CHECK(refusal([] { Torus(1, -1); }) ==
          "contact::Torus: the radius of the tube of a torus must be positive and finite, got -1");
    CHECK(refusal([] { Torus(0, 1); }) ==
          "contact::Torus: the radius of the ring of a torus must be positive and finite, got 0");
    CHECK(refusal([] { Torus(1, 1); }) ==
          "contact::Torus: the radius of the tube of a torus must be less than that of its ring, got 1");
    CHECK(refusal([] {
              Superquadric({1, -1, 1}, 3);
          }) == "contact::Superquadric: a semi-axis of a superquadric must be positive and finite, got -1");
    CHECK(refusal([] {
              Superquadric({1, 1, 1}, 2, 1.5);
          }) == "contact::Superquadric: an exponent of a superquadric must be between 2 and 100, got 1.5");
    CHECK(refusal([] { Paraboloid(1, -2); }) ==
          "contact::Paraboloid: a radius of a paraboloid must be positive and finite, got -2");
    CHECK(refusal([] { Cone{0}; }) ==
          "contact::Cone: the half angle of a cone must be between 0 and pi/2, got 0");
    CHECK(refusal([&] { Cone{nan}; }) ==
          "contact::Cone: the half angle of a cone must be between 0 and pi/2, got nan");
    CHECK(refusal([] { ImplicitSurface(Bumps{}, 0); }) ==
          "contact::ImplicitSurface: the size of a surface must be positive and finite, got 0");
}

TEST_CASE("quadrics that are not a regular surface are rejected", "[contact][surface]")
{
    const Mat3 I = Mat3::Identity(), twice = Vec3(1, 1, 0).asDiagonal(), once = Vec3(0, 0, 1).asDiagonal();
    const Vec3 none = Vec3::Zero();
    const std::string point = "G = 0 must be a surface; it is a point, a line or a double plane";
    const std::string crossed = "G = 0 must not intersect itself; it is a double cone or two planes";
    const std::string empty = "G = 0 must have points; G does not change its sign";
    CHECK(Quadric::fault(Mat3::Zero(), {0, 0, 1}, 1) == "Q must not be zero; use a plane");
    CHECK(Quadric::fault(lie::tilde({0, 0, 1}) + I, none, -1) == "Q must be symmetric");
    CHECK(Quadric::fault(I, {0, NAN, 1}, 1) == "the coefficients must be finite");
    CHECK(Quadric::fault(I, {1, 2, 3}, 14) == point);
    CHECK(Quadric::fault(twice, none, 0) == point);
    CHECK(Quadric::fault(once, {0, 0, 1}, 1) == point);
    CHECK(Quadric::fault(Vec3(1, 1, -1).asDiagonal(), none, 0) == crossed);
    CHECK(Quadric::fault(Vec3(1, 0, -1).asDiagonal(), {1, 0, 1}, 0) == crossed);
    CHECK(Quadric::fault(I, {1, 2, 3}, 15) == empty);
    CHECK(Quadric::fault(-twice, none, -1) == empty);
    CHECK(Quadric::fault(I, {1, 2, 3}, 13).empty());
    CHECK(Quadric::fault(twice, {0, 0, 1}, 7).empty());
    CHECK(Quadric::fault(once, none, -1).empty());
    CHECK(Quadric::fault(Vec3(1, -1, 0).asDiagonal(), none, 1).empty());
    CHECK_THROWS_WITH(Quadric(I, none, 1),
                      "contact::Quadric: G = 0 must have points; G does not change its sign, "
                      "got Q = [1, 0, 0; 0, 1, 0; 0, 0, 1], b = 0 0 0, c = 1");
}

TEST_CASE("the normal is undefined where the gradient vanishes", "[contact][surface]")
{
    CHECK_THROWS_WITH(Ellipsoid({1, 2, 3}).normal({0, 0, 0}),
                      "a surface has no normal at (0, 0, 0): the gradient of G vanishes");
    CHECK_THROWS_AS(Torus(1, 0.2).normal({0, 0, 0.1}), lie::NumericalFailure);
    CHECK_THROWS_WITH(Cone(0.5).normal({0, 0, 0}),
                      "a surface has no normal at (0, 0, 0): the gradient of G vanishes");
    CHECK_THROWS_WITH(Cone(0.5).shape_operator({0, 0, -1}),
                      "a surface has no normal at (0, 0, -1): the gradient of G vanishes");
    CHECK_THROWS_WITH(Cone(0.5).project({0.1, 0, -1}),
                      "the closest point of a cone to (0.1, 0, -1) is its apex, "
                      "where the normal is undefined");
    CHECK_THROWS_AS(Cone(0.5).project({0, 0, 1}), lie::NumericalFailure);
    CHECK_THROWS_AS(Cylinder(1).shape_operator({0, 0, 1}), lie::NumericalFailure);
    CHECK_THROWS_AS(Sphere(1).project({0, 0, 0}), lie::NumericalFailure);
    CHECK_THROWS_AS(Cylinder(1).project({0, 0, 3}), lie::NumericalFailure);
    CHECK_THROWS_AS(Torus(1, 0.2).project({0, 0, 3}), lie::NumericalFailure);
}
