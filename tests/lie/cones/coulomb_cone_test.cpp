// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/coulomb_cone.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

TEST_CASE("the projection onto the Coulomb cone satisfies Moreau's decomposition", "[lie][cones]")
{
    std::mt19937 random(GENERATE(1, 2, 3));
    std::normal_distribution<double> normal;
    for (const double mu : {0., 0.3, 2.})
        for (int n = 0; n < 100; ++n) {
            const Vec3 x(normal(random), normal(random), normal(random));
            const Vec3 p = lie::project_on_cone(x, mu), polar = x - p;
            INFO("mu " << mu << ", x " << x.transpose());
            CHECK(p.tail<2>().norm() <= mu * p[0] + 1e-15);
            CHECK(mu * polar.tail<2>().norm() <= -polar[0] + (mu > 0 ? 1e-15 : 0) + 1e-15);
            CHECK(std::abs(p.dot(polar)) < 1e-14);
        }
}

TEST_CASE("the projection onto the Coulomb cone is idempotent, nonexpansive and homogeneous", "[lie][cones]")
{
    tests::Random random(2);
    for (const double mu : {0., 1e-8, 0.3, 1., 5.})
        for (int n = 0; n < 200; ++n) {
            const Vec3 a = random.vector(3), b = random.vector(3);
            const Vec3 p = lie::project_on_cone(a, mu);
            INFO("mu " << mu << ", a " << a.transpose());
            CHECK((lie::project_on_cone(p, mu) - p).norm() <= 1e-15 * a.norm());
            CHECK((p - lie::project_on_cone(b, mu)).norm() <= (a - b).norm() * (1 + 1e-14));
            CHECK((lie::project_on_cone(2.5 * a, mu) - 2.5 * p).norm() <= 1e-14 * a.norm());
        }
}

TEST_CASE("points on the axis of the Coulomb cone are projected for any coefficient of friction",
          "[lie][cones]")
{
    CHECK(lie::project_on_cone({0.5, 3, 4}, 0) == Vec3(0.5, 0, 0));
    CHECK(lie::project_on_cone({-0.5, 3, 4}, 0) == Vec3::Zero());
    CHECK(lie::project_on_cone({2, 3, 4}, 2.5) == Vec3(2, 3, 4));
    for (const double mu : {0., 1e-300, 1e-8, 0.3, 1e8}) {
        INFO("mu " << mu);
        for (const double zero : {0., -0.}) {
            CHECK(lie::project_on_cone({-0.5, zero, -zero}, mu) == Vec3::Zero());
            CHECK(lie::project_on_cone({0.5, zero, -zero}, mu) == Vec3(0.5, 0, 0));
            CHECK(lie::project_on_cone({zero, 0, zero}, mu) == Vec3::Zero());
        }
    }
}

TEST_CASE("the derivative of the projection is that of finite differences", "[lie][cones]")
{
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    constexpr double step = 1e-6;
    for (const double mu : {0., 0.3, 2.})
        for (int n = 0; n < 100; ++n) {
            const Vec3 x(normal(random), normal(random), normal(random));
            Mat3 difference;
            for (int k = 0; k < 3; ++k)
                difference.col(k) = (lie::project_on_cone(x + step * Vec3::Unit(k), mu) -
                                     lie::project_on_cone(x - step * Vec3::Unit(k), mu)) /
                                    (2 * step);
            INFO("mu " << mu << ", x " << x.transpose());
            CHECK((lie::cone_projection_derivative(x, mu) - difference).norm() < 1e-4);
        }
}
