// SPDX-License-Identifier: GPL-3.0-or-later
/// The contact force on a rigid ball that slides in an ellipsoidal bowl: exact bowl against height map and
/// mesh. The force depends on the curvature; it must converge and must not jump at the borders of cells,
/// patches or triangles.

#include "contact/mesh/height_map.hpp"
#include "contact/mesh/mesh_surface.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/tangent_basis.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/icosphere.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;

namespace {

const Vec3 D(2.5, 2.7, 2.3), gravity(0, 0, -9.81);
constexpr double R_ball = 0.5, m_ball = 1;

/// The centre of a ball in contact with the bowl of semi-axes D, on a curve around the bottom of the bowl
Vec3 centre(double t)
{
    const double down = 0.35 + 0.15 * std::sin(3 * t), around = 2 * t;
    const Vec3 a = D.cwiseProduct(
        Vec3(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), -std::cos(down)));
    return a + R_ball * Ellipsoid(D, true).normal(a);
}

/// The contact force on a ball at c with velocity ċ, without friction. With n out of the ball and s = Tᵀċ,
/// the second derivative of the gap without contact force and the force that makes it zero are
///
///     g̈_0 = -n·g - sᵀ K_i (K_i + K_j)⁻¹ K_j s,   F_N = -m g̈_0
double normal_force(const Surface& bowl, const Vec3& c, const Vec3& cdot)
{
    const Vec3 a = bowl.project(c), n = -bowl.normal(a);
    const Eigen::Matrix<double, 3, 2> T = tangent_basis(n);
    const Eigen::Matrix2d K_i = Eigen::Matrix2d::Identity() / R_ball,
                          K_j = T.transpose() * bowl.shape_operator(a) * T;
    const Eigen::Vector2d s = T.transpose() * cdot;
    return m_ball * (n.dot(gravity) - s.dot(K_i * (K_i + K_j).inverse() * K_j * s));
}

struct Difference {
    double rms, largest, peak;  // relative to the exact force: rms and largest difference, largest force
};

/// The differences along the curve
Difference difference(const Surface& bowl)
{
    const Ellipsoid exact(D, true);
    Difference d{0, 0, 0};
    constexpr int instants = 200;
    for (int k = 0; k < instants; ++k) {
        const double t = 2 * std::numbers::pi * k / instants;
        const Vec3 c = centre(t), cdot = tests::derivative([&](double tau) { return centre(t + tau); });
        const double F = normal_force(exact, c, cdot), F_h = normal_force(bowl, c, cdot);
        REQUIRE(F > 9);
        d.rms += std::pow(F_h / F - 1, 2) / instants;
        d.largest = std::max(d.largest, std::abs(F_h / F - 1));
        d.peak = std::max(d.peak, F_h / F);
    }
    d.rms = std::sqrt(d.rms);
    return d;
}

void check_order(const Difference& coarse, const Difference& fine, double refined)
{
    const double order_rms = std::log(coarse.rms / fine.rms) / std::log(refined);
    const double order_largest = std::log(coarse.largest / fine.largest) / std::log(refined);
    INFO("rms " << coarse.rms << " and " << fine.rms << ", order " << order_rms << "; most " << coarse.largest
                << " and " << fine.largest << ", order " << order_largest);
    CHECK(order_rms == Approx(2).margin(0.3));
    CHECK(order_largest == Approx(2).margin(0.6));
    CHECK(coarse.peak < 1.02);
    CHECK(fine.peak < 1.005);
}

}  // namespace

TEST_CASE("the normal force in a spherical bowl equals the closed form", "[contact][sampled]")
{
    // In a spherical bowl, with the ball centre at the distance ρ - R from the centre of the bowl: F_N = m
    // (v²/(ρ - R) + g cos θ)
    const double rho = 2, theta = 0.4;
    const Ellipsoid bowl({rho, rho, rho}, true);
    const Vec3 down(std::sin(theta), 0, -std::cos(theta)),
        cdot(3 * std::cos(theta), 0.5, 3 * std::sin(theta));
    CHECK(normal_force(bowl, (rho - R_ball) * down, cdot) ==
          Approx(m_ball * (cdot.squaredNorm() / (rho - R_ball) + 9.81 * std::cos(theta))).epsilon(1e-13));
}

TEST_CASE("the contact force on a height map converges with order 2 and has no peaks", "[contact][sampled]")
{
    const auto bowl = [](double x, double y) {
        return -D.z() * std::sqrt(1 - x * x / (D.x() * D.x()) - y * y / (D.y() * D.y()));
    };
    const auto sampled = [&](int cells) {
        return HeightMap::sampled(bowl, {-1.6, -1.6}, {1.6, 1.6}, cells + 1, cells + 1);
    };
    check_order(difference(sampled(16)), difference(sampled(64)), 4);  // spacing 0.2 and 0.05
}

TEST_CASE("the contact force on a mesh converges with order 2 and has no peaks", "[contact][sampled][mesh]")
{
    const auto meshed = [](int levels) {
        return MeshSurface(
            tests::image(tests::icosphere(levels), [](const Vec3& v) { return Vec3(D.cwiseProduct(v)); }),
            true);
    };
    check_order(difference(meshed(2)), difference(meshed(3)), 2);  // longest edges 0.87 and 0.44
}
