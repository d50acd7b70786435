// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/multifrontal_lu.hpp"

#include "lie/check.hpp"

#include <Eigen/LU>

#include <catch2/catch.hpp>

#include <algorithm>
#include <complex>
#include <limits>
#include <numeric>
#include <random>

using namespace hilda;

namespace {

constexpr int n = 57;

/// A matrix of random blocks in random places, with a dominant diagonal, and its dense copy
template <class Scalar>
class RandomMatrix {
public:
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

    explicit RandomMatrix(unsigned seed) : random(seed)
    {
        std::vector<int> order(n);
        std::iota(order.begin(), order.end(), 0);
        std::shuffle(order.begin(), order.end(), random);
        // Each diagonal entry is a block. The unknown 0 has no other entry; 20 is coupled to 50 others in
        // one direction.
        for (int k = 0; k < n; ++k) declare(k, k, 1, 1);
        for (int k = 0; k < 14; ++k) declare(1 + below(n - 7), 1 + below(n - 7), 1 + below(6), 1 + below(6));
        declare(20, 5, 1, 50);
        N.analyse(n, order);
    }
    void set_random(double diagonal)
    {
        N.set_zero();
        dense.setZero();
        for (const Block& b : block) {
            const Matrix values = Matrix::Random(b.rows, b.columns);
            add(b, values);
        }
        for (int k = 0; k < n; ++k) add(block[k], Matrix::Constant(1, 1, diagonal));
    }

    lie::MultifrontalLu<Scalar> N;
    Matrix dense = Matrix::Zero(n, n);

private:
    struct Block {
        int handle, row, column, rows, columns;
    };
    int below(int limit) { return static_cast<int>(random() % static_cast<unsigned>(limit)); }
    void declare(int row, int column, int rows, int columns)
    {
        block.push_back({N.declare(row, column, rows, columns), row, column, rows, columns});
    }
    void add(const Block& b, const Matrix& values)
    {
        N.add(b.handle, values);
        dense.block(b.row, b.column, b.rows, b.columns) += values;
    }

    std::mt19937 random;
    std::vector<Block> block;
};

/// Solves with random matrices.
template <class Scalar>
void compare_with_dense()
{
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        RandomMatrix<Scalar> matrix(seed);
        for (int repeat = 0; repeat < 2; ++repeat) {
            matrix.set_random(60);
            const Vector x = Vector::Random(n);
            Vector b = matrix.dense * x;
            matrix.N.factor();
            matrix.N.solve(b);
            INFO("seed " << seed << ", matrix " << repeat);
            CHECK((b - x).norm() < 1e-14 * n * x.norm());
            CHECK(matrix.N.reciprocal_condition() > 0.5);
            CHECK(matrix.N.reciprocal_condition() <= 1);
        }
        CHECK(matrix.N.factorizations() == 2);
    }
}

}  // namespace

TEST_CASE("multifrontal factors solve as dense ones")
{
    SECTION("double") { compare_with_dense<double>(); }
    SECTION("complex") { compare_with_dense<std::complex<double>>(); }
}

TEST_CASE("multifrontal factors have the diagonal pivots in the given order")
{
    // With the pivot 1e-9 first the solution loses nine digits, with the other order none.
    for (const bool small_first : {true, false}) {
        lie::MultifrontalLu<double> N;
        const int at = N.declare(0, 0, 2, 2);
        N.analyse(2, small_first ? std::vector<int>{0, 1} : std::vector<int>{1, 0});
        Eigen::Matrix2d A;
        A << 1e-9, 1, 1, 0.7;
        N.set_zero();
        N.add(at, A);
        N.factor();
        const Eigen::Vector2d x(1 / 3., 0.1);
        Eigen::VectorXd b = A * x;
        N.solve(b);
        const double error = (b - x).norm();
        CHECK((small_first ? error > 1e-10 && error < 1e-6 : error < 1e-15));
    }
}

TEST_CASE("multifrontal factors refuse a zero pivot and numbers that are not finite")
{
    lie::MultifrontalLu<double> N;
    const int at = N.declare(0, 0, 2, 2), last = N.declare(2, 2, 1, 1);
    N.analyse(3, {0, 1, 2});
    const auto factor = [&](double a, double b) {
        N.set_zero();
        N.add(at, Eigen::Matrix2d::Constant(a));
        N.add(at, Eigen::Matrix2d::Identity());
        N.add(last, b);
        N.factor();
    };
    CHECK_NOTHROW(factor(1, 1));
    CHECK_THROWS_AS(factor(1, 0), lie::SingularMatrix);
    CHECK_THROWS_AS(factor(-1, 1), lie::SingularMatrix);  // a zero pivot, although A has an inverse
    CHECK_THROWS_AS(factor(1, std::numeric_limits<double>::quiet_NaN()), lie::NonFinite);
    CHECK_THROWS_AS(factor(std::numeric_limits<double>::infinity(), 1), lie::NonFinite);
}
