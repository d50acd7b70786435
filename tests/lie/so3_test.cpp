// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/euler_angles.hpp"
#include "lie/euler_parameters.hpp"

#include <catch2/catch.hpp>

#include <numbers>
#include <random>

using namespace hilda::lie;

namespace {

using std::numbers::pi;
constexpr double eps = std::numeric_limits<double>::epsilon();

using Long = long double;
using LongMat3 = Eigen::Matrix<Long, 3, 3>;
using LongVec3 = Eigen::Matrix<Long, 3, 1>;

LongMat3 tilde_long(const LongVec3& a)
{
    LongMat3 S;
    S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return S;
}

/// Σ θ̃ⁿ first!/(n + first)! in extended precision: exp for first = 0, the left Jacobian for first = 1
LongMat3 power_series(const Vec3& theta, int first)
{
    const LongMat3 X = tilde_long(theta.cast<Long>());
    LongMat3 sum = LongMat3::Identity(), term = LongMat3::Identity();
    for (int n = 1; n < 60; ++n) {
        term = term * X / static_cast<Long>(n + first);
        sum += term;
    }
    return sum;
}

double distance(const Mat3& a, const LongMat3& b)
{
    return static_cast<double>((a.cast<Long>() - b).cwiseAbs().maxCoeff());
}

Vec3 random_direction(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    return Vec3(normal(random), normal(random), normal(random)).normalized();
}

const double angles[] = {0,   1e-300,    1e-16, 1e-8, 1e-4, 0.1,       0.4999999,
                         0.5, 0.5000001, 1,     2,    3,    pi - 1e-8, pi};

}  // namespace

TEST_CASE("tilde(a) b is the cross product and vee is the inverse of tilde", "[lie][so3]")
{
    const Vec3 a(1, -2, 3), b(0.4, 5, -6);
    CHECK((tilde(a) * b - a.cross(b)).norm() == 0);
    CHECK(vee(tilde(a)) == a);
}

TEST_CASE("exp and the right Jacobian are accurate to 1e-15 at every angle", "[lie][so3]")
{
    std::mt19937_64 random(7);
    for (const double angle : angles)
        for (int n = 0; n < 20; ++n) {
            const Vec3 theta = angle * random_direction(random);
            INFO("angle " << angle);
            CHECK(distance(exp(theta), power_series(theta, 0)) < 1e-15);
            CHECK(distance(right_jacobian(theta), power_series(-theta, 1)) < 1e-15);
            CHECK(orthogonality_error(exp(theta)) < 2e-15);
        }
}

TEST_CASE("log(exp(theta)) has full relative accuracy for small angles", "[lie][so3]")
{
    std::mt19937_64 random(8);
    for (const double angle : {1e-300, 1e-16, 1e-8, 1e-4}) {
        const Vec3 theta = angle * random_direction(random);
        INFO("angle " << angle);
        CHECK((log(exp(theta)) - theta).norm() <= 4 * eps * angle);
    }
}

TEST_CASE("log is the inverse of exp at every angle", "[lie][so3]")
{
    std::mt19937_64 random(9);
    for (const double angle : angles)
        for (int n = 0; n < 20; ++n) {
            const Vec3 theta = angle * random_direction(random);
            const Vec3 back = log(exp(theta));
            INFO("angle " << angle);
            CHECK((exp(back) - exp(theta)).cwiseAbs().maxCoeff() < 1e-15);
            CHECK(back.norm() <= pi * (1 + eps));
            if (angle < pi - 1e-4) CHECK((back - theta).norm() < 1e-15 * std::max(1.0, 2 * angle));
        }
    CHECK(log(Mat3::Identity()) == Vec3::Zero());
    for (int k = 0; k < 3; ++k) {  // exact half turns: the skew-symmetric part of A is zero
        const Mat3 A = 2 * Vec3::Unit(k) * Vec3::Unit(k).transpose() - Mat3::Identity();
        CHECK(std::abs(log(A)[k]) == Approx(pi).epsilon(eps));
    }
}

TEST_CASE("right_jacobian_inverse is the inverse of right_jacobian", "[lie][so3]")
{
    std::mt19937_64 random(10);
    for (const double angle : angles) {
        const Vec3 theta = angle * random_direction(random);
        INFO("angle " << angle);
        CHECK(
            (right_jacobian(theta) * right_jacobian_inverse(theta) - Mat3::Identity()).cwiseAbs().maxCoeff() <
            (angle < 2 ? 1e-15 : 3e-15));
    }
}

TEST_CASE("the right Jacobian agrees with differences of exp", "[lie][so3]")
{
    std::mt19937_64 random(11);
    for (const double angle : {1e-8, 0.3, 0.5, 2.0, 3.1}) {
        const Vec3 theta = angle * random_direction(random), direction = random_direction(random);
        const double d = 1e-5;
        const Vec3 quotient = (log(exp(theta).transpose() * exp(theta + d * direction)) -
                               log(exp(theta).transpose() * exp(theta - d * direction))) /
                              (2 * d);
        CHECK((quotient - right_jacobian(theta) * direction).norm() < 1e-9);
    }
}

TEST_CASE("the nearest rotation to a perturbed rotation is proper and differs by the perturbation at most",
          "[lie][so3]")
{
    std::mt19937_64 random(12);
    for (int n = 0; n < 20; ++n) {
        const Mat3 A = exp(3 * random_direction(random)), noise = 1e-6 * Mat3::Random();
        const Mat3 B = nearest_rotation(A + noise);
        CHECK(orthogonality_error(B) < 5e-15);
        CHECK(B.determinant() == Approx(1));
        CHECK((B - A).norm() < 2 * noise.norm());
    }
    CHECK(nearest_rotation(Vec3(1, 1, -1).asDiagonal()).determinant() == Approx(1));
}

TEST_CASE("Euler parameters and rotations convert into each other at every angle", "[lie][euler]")
{
    std::mt19937_64 random(13);
    for (const double angle : angles)
        for (int n = 0; n < 10; ++n) {
            const Mat3 A = exp(angle * random_direction(random));
            const Vec4 p = euler_parameters(A);
            INFO("angle " << angle);
            CHECK(p.norm() == Approx(1).epsilon(eps));
            CHECK(p[0] >= 0);
            CHECK((rotation(p) - A).cwiseAbs().maxCoeff() < 2e-15);
            CHECK((E(p) * G(p).transpose() - A).cwiseAbs().maxCoeff() < 2e-15);
            CHECK((G(p) * p).norm() < 1e-15);
        }
}

TEST_CASE("2 G pdot is the body-frame angular velocity", "[lie][euler]")
{
    std::mt19937_64 random(14);
    const Vec3 omega_bar(0.3, -1.2, 0.8);
    const Mat3 A = exp(random_direction(random));
    const double d = 1e-5;
    const Vec4 pdot =
        (euler_parameters(A * exp(d * omega_bar)) - euler_parameters(A * exp(-d * omega_bar))) / (2 * d);
    CHECK((2 * G(euler_parameters(A)) * pdot - omega_bar).norm() < 1e-9);
}

TEST_CASE(
    "Euler angles and rotations convert into each other, and B is the map to the body-frame angular velocity",
    "[lie][euler]")
{
    std::mt19937_64 random(15);
    std::uniform_real_distribution<double> turn(-3.1, 3.1), nutation(0.05, 3.09);
    for (int n = 0; n < 50; ++n) {
        const Vec3 e(turn(random), nutation(random), turn(random)), edot = random_direction(random);
        CHECK((euler_angles(rotation(e)) - e).norm() < 1e-13);
        const double d = 1e-5;
        const Vec3 omega_bar =
            log(rotation(Vec3(e - d * edot)).transpose() * rotation(Vec3(e + d * edot))) / (2 * d);
        CHECK((omega_bar - B(e) * edot).norm() < 1e-8);
    }
    CHECK(distance_to_singular_set(Vec3(1, pi - 0.25, 2)) == Approx(0.25));
    CHECK(distance_to_singular_set(Vec3(1, 1e-8, 2)) == Approx(1e-8));
    CHECK((rotation(euler_angles(Mat3::Identity())) - Mat3::Identity()).norm() < 1e-15);
}
