// SPDX-License-Identifier: GPL-3.0-or-later
/// Height maps: exactness for cubics, convergence for smooth functions, continuity of the derivatives.

#include "contact/mesh/height_map.hpp"
#include "lie/check.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;
using Eigen::Vector2d;
using tests::derivative;
using tests::Random;

namespace {

struct Polynomial {
    Eigen::Matrix4d c;  // of x^i y^j

    /// The derivative ∂^(m+n) / ∂x^m ∂y^n
    double at(double x, double y, int m = 0, int n = 0) const
    {
        double sum = 0;
        for (int i = m; i < 4; ++i)
            for (int j = n; j < 4; ++j) {
                double term = c(i, j) * std::pow(x, i - m) * std::pow(y, j - n);
                for (int k = 0; k < m; ++k) term *= i - k;
                for (int k = 0; k < n; ++k) term *= j - k;
                sum += term;
            }
        return sum;
    }
};

/// sin(x) cos(y/2) with its derivatives
struct Waves {
    static double f(double x, double y) { return std::sin(x) * std::cos(0.5 * y); }
    static Vec3 gradient(const Vec3& a)
    {
        return {-std::cos(a.x()) * std::cos(0.5 * a.y()), 0.5 * std::sin(a.x()) * std::sin(0.5 * a.y()), 1};
    }
    static Mat3 hessian(const Vec3& a)
    {
        Mat3 H = Mat3::Zero();
        H(0, 0) = f(a.x(), a.y());
        H(1, 1) = 0.25 * f(a.x(), a.y());
        H(0, 1) = H(1, 0) = 0.5 * std::cos(a.x()) * std::sin(0.5 * a.y());
        return H;
    }
};

HeightMap waves(int cells) { return HeightMap::sampled(Waves::f, {-2, -1}, {2, 3}, cells + 1, cells + 1); }

/// The largest errors of f, ∇f and ∇²f at the same points of all cells, up to the edge
Vec3 height_map_errors(int cells)
{
    const HeightMap map = waves(cells);
    Vec3 worst = Vec3::Zero();
    for (int i = 0; i <= 3 * cells; ++i)
        for (int j = 0; j <= 3 * cells; ++j) {
            const double part = 4. / (3 * cells);
            const Vec3 a(-2 + i * part, -1 + j * part, 0);
            const auto [G, gradient, hessian] = map.derivatives(a);
            worst = worst.cwiseMax(Vec3(std::abs(G + Waves::f(a.x(), a.y())),
                                        (gradient - Waves::gradient(a)).norm(),
                                        (hessian - Waves::hessian(a)).norm()));
        }
    return worst;
}

}  // namespace

TEST_CASE("a height map is exact for a cubic", "[contact][height_map]")
{
    Random random(GENERATE(range(0u, 5u)));
    const int n_x = GENERATE(4, 5, 6, 9), n_y = GENERATE(4, 7);
    Polynomial p;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) p.c(i, j) = random.number();
    const HeightMap map =
        HeightMap::sampled([&](double x, double y) { return p.at(x, y); }, {-1, -0.5}, {0.5, 1}, n_x, n_y);
    for (int k = 0; k < 20; ++k) {
        const double x = random.number(-1, 0.5), y = random.number(-0.5, 1);
        const auto [G, gradient, hessian] = map.derivatives({x, y, 0.3});
        CHECK(G == Approx(0.3 - p.at(x, y)).margin(1e-14));
        CHECK((gradient - Vec3(-p.at(x, y, 1, 0), -p.at(x, y, 0, 1), 1)).norm() < 2e-13);
        CHECK(hessian(0, 0) == Approx(-p.at(x, y, 2, 0)).margin(3e-12));
        CHECK(hessian(0, 1) == Approx(-p.at(x, y, 1, 1)).margin(3e-12));
        CHECK(hessian(1, 1) == Approx(-p.at(x, y, 0, 2)).margin(3e-12));
        CHECK(hessian.col(2).norm() == 0);
    }
}

TEST_CASE("f, gradient and Hessian of a height map converge with orders 4, 3 and 2", "[contact][height_map]")
{
    const Vec3 coarse = height_map_errors(16), fine = height_map_errors(32);
    const Vec3 order = (coarse.cwiseQuotient(fine).array().log() / std::log(2)).matrix();
    INFO("errors " << coarse.transpose() << " and " << fine.transpose() << ", orders " << order.transpose());
    CHECK(order[0] == Approx(4).margin(0.15));
    CHECK(order[1] == Approx(3).margin(0.15));
    CHECK(order[2] == Approx(2).margin(0.15));
}

TEST_CASE("the second derivatives of a height map are continuous across cells", "[contact][height_map]")
{
    Random random(GENERATE(range(0u, 5u)));
    Eigen::MatrixXd heights(8, 9);
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 9; ++j) heights(i, j) = random.number();
    const HeightMap map(heights, {0, 0}, {1, 0.5});
    constexpr double step = 1e-12;
    const auto jump = [&](const Vec3& a, const Vec3& across) {
        const auto before = map.derivatives(a - step * across), after = map.derivatives(a + step * across);
        CHECK(std::abs(before.G - after.G) < 1e-10);
        CHECK((before.gradient - after.gradient).norm() < 1e-9);
        CHECK((before.hessian - after.hessian).norm() < 1e-9);
    };
    for (int i = 1; i < 7; ++i) jump({1. * i, random.number(0.1, 3.9), 0}, Vec3::UnitX());
    for (int j = 1; j < 8; ++j) jump({random.number(0.1, 6.9), 0.5 * j, 0}, Vec3::UnitY());
    // it interpolates all samples, including those on the edge
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 9; ++j) CHECK(std::abs(map.value({1. * i, 0.5 * j, heights(i, j)})) < 1e-14);
    // gradient and Hessian agree with finite differences
    const Vec3 a(random.number(2.1, 2.9), random.number(2.1, 2.4), 0);
    for (int k = 0; k < 3; ++k) {
        const auto moved = [&](double tau) { return Vec3(a + tau * Vec3::Unit(k)); };
        CHECK(map.gradient(a)[k] ==
              Approx(derivative([&](double tau) { return map.value(moved(tau)); })).margin(1e-10));
        CHECK((map.hessian(a).col(k) - derivative([&](double tau) {
                   return Vec3(map.gradient(moved(tau)));
               })).norm() < 1e-9);
    }
}

TEST_CASE("the projection onto a height map is its closest point", "[contact][height_map]")
{
    Random random(GENERATE(range(0u, 10u)));
    const HeightMap map = HeightMap::sampled(Waves::f, {-9, -9}, {9, 9}, 60, 60);
    for (const Vec3& a : {random.vector(2), Vec3(random.vector(0.5) + Vec3(1.5, 0, 3)), Vec3(1.5, 0, 4)}) {
        const Vec3 x = map.project(a);
        CHECK(std::abs(map.value(x)) < 1e-14);
        CHECK((a - x).cross(map.normal(x)).norm() < 3e-14);
        for (int k = 0; k < 100; ++k) {
            const double u = random.number(-5, 5), v = random.number(-5, 5);
            CHECK((Vec3(u, v, -map.value({u, v, 0})) - a).norm() >= (x - a).norm() - 1e-14);
        }
    }
}

TEST_CASE("the evaluation of a height map outside its grid fails with the point", "[contact][height_map]")
{
    const HeightMap map = waves(8);
    CHECK_NOTHROW(map.value({2, 3, 0}));
    CHECK_NOTHROW(map.value({-2, -1, 0}));
    CHECK_THROWS_AS(map.value({2.001, 0, 0}), lie::NumericalFailure);
    CHECK_THROWS_WITH(map.normal({0, -1.5, 7}),
                      "a height map is not defined outside its grid: point (0, -1.5, 7)");
    CHECK(std::isnan(map.value({std::nan(""), 0, 0})));
    CHECK_THROWS_AS(map.normal({0, 0, std::nan("")}), lie::NumericalFailure);
    CHECK_THROWS_WITH(map.project({5, 0, 1}),
                      "the closest point of a height map lies on the edge of its grid: point (5, 0, 1)");
}

TEST_CASE("the evaluation of a height map does not allocate memory", "[contact][height_map][allocation]")
{
    const HeightMap map = waves(8);
    Vec3 sum = Vec3::Zero();
    CHECK(tests::allocations_during([&] {
              sum += map.derivatives({0.1, 0.2, 0.3}).gradient + map.normal({0.5, 0, 0});
              sum += map.project({0.1, 0.2, 0.9}) + map.shape_operator({0.5, 1, 0}).col(0);
          }) == 0);
    CHECK(sum.allFinite());
}

TEST_CASE("a height map with invalid samples is rejected", "[contact][height_map]")
{
    const Eigen::MatrixXd flat = Eigen::MatrixXd::Zero(4, 5);
    CHECK_THROWS_WITH(HeightMap(Eigen::MatrixXd::Zero(4, 3), {0, 0}, {1, 1}),
                      "contact::HeightMap: a height map needs at least 4 samples in each direction, got 3");
    CHECK_THROWS_WITH(HeightMap(flat, {0, 0}, {1, -1}),
                      "contact::HeightMap: the spacing of a height map must be positive and finite, got -1");
    CHECK_THROWS_WITH(HeightMap(flat, {0, INFINITY}, {1, 1}),
                      "contact::HeightMap: the corner must be finite, got   0 inf");
    CHECK_THROWS_WITH(HeightMap(flat * std::nan(""), {0, 0}, {1, 1}),
                      "contact::HeightMap: the heights must be finite, got a value that is not finite");
}
