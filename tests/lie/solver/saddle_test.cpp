// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/saddle.hpp"
#include "lie/check.hpp"
#include "lie/system.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <Eigen/LU>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// A chain of bodies with random rows between neighbours
class RandomChain final : public lie::System {
public:
    explicit RandomChain(int n)
    {
        for (int b = 0; b < n; ++b) {
            inertia.m.push_back(std::pow(10.0, b % 5 - 2));
            const Mat3 A = lie::exp(Vec3::Random());
            inertia.J_bar.push_back(A * Vec3(1e-3, 2e-3, 2.5e-3).asDiagonal() * A.transpose());
            for (int k = 0; k < 3; ++k) {
                if (b > 0)
                    rows_pattern.entry.push_back(
                        {.body = b - 1, .nonzero = 0b111111, .r = Vec3::Random(), .pi = Vec3::Random()});
                rows_pattern.entry.push_back(
                    {.body = b, .nonzero = 0b111000, .r = Vec3::Zero(), .pi = Vec3::Random()});
                rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
            }
        }
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads&) const override {}
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        out = rows_pattern;
        for (lie::Rows::Entry& entry : out.entry) entry.pi *= factor + x.t * entry.pi.x();
    }
    double factor = 1;

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

Eigen::MatrixXd dense(const lie::System& system, const lie::Rows& C)
{
    const int n = 6 * system.bodies();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + C.rows(), n + C.rows());
    for (int b = 0; b < system.bodies(); ++b) {
        K.block<3, 3>(6 * b, 6 * b) = system.mass().m[b] * Mat3::Identity();
        K.block<3, 3>(6 * b + 3, 6 * b + 3) = system.mass().J_bar[b];
    }
    for (int k = 0; k < C.rows(); ++k)
        for (int e = C.start[k]; e < C.start[k + 1]; ++e) {
            K.block<1, 3>(n + k, 6 * C.entry[e].body) = C.entry[e].r.transpose();
            K.block<1, 3>(n + k, 6 * C.entry[e].body + 3) = C.entry[e].pi.transpose();
        }
    K.topRightCorner(n, C.rows()) = K.bottomLeftCorner(C.rows(), n).transpose();
    return K;
}

}  // namespace

TEST_CASE("products and solutions of the saddle matrix agree with those of the dense matrix", "[lie][saddle]")
{
    const RandomChain chain(7);
    lie::Saddle K(chain);
    lie::State x;
    for (const double t : {0.0, 0.1, 0.5}) {
        x.t = t;
        K.assemble(x);
        const Eigen::MatrixXd D = dense(chain, K.rows());
        const Eigen::VectorXd z = Eigen::VectorXd::Random(K.size());
        Eigen::VectorXd b(K.size());
        K.multiply(z, b);
        CHECK((b - D * z).norm() < 1e-13 * (D * z).norm());
        K.solve_refined(b);
        CHECK((b - z).norm() < 1e-11 * z.norm());
    }
    CHECK(K.factorizations() == 1);
    CHECK(K.refactorizations() == 2);
}

TEST_CASE("new pivots are chosen when the old ones have become inaccurate", "[lie][saddle]")
{
    RandomChain chain(5);
    lie::Saddle K(chain);
    lie::State x;
    K.assemble(x);
    chain.factor = 1e5;  // changes the scale of the rows
    K.assemble(x);
    chain.factor = 1e-5;
    K.assemble(x);
    Eigen::VectorXd z = Eigen::VectorXd::Random(K.size()), b(K.size());
    K.multiply(z, b);
    K.solve_refined(b);
    CHECK((b - z).norm() < 1e-8 * z.norm());
    CHECK(K.factorizations() > 1);
}

TEST_CASE("a singular or non-finite saddle matrix throws an exception", "[lie][saddle]")
{
    struct DuplicateRow final : lie::System {  // two rows, equal for t = 0
        DuplicateRow()
        {
            inertia.m = {1};
            inertia.J_bar = {Mat3::Identity()};
            rows_pattern.entry = {{}, {}};
            rows_pattern.start = {0, 1, 2};
        }
        const lie::Mass& mass() const override { return inertia; }
        const lie::Rows& pattern() const override { return rows_pattern; }
        void loads(const lie::State&, lie::Loads&) const override {}
        void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
        void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
        void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
        void variation(const lie::State& x, lie::Rows& out) const override
        {
            out.entry[0].r = Vec3(1, 2, 3);
            out.entry[1].r = Vec3(1, 2, 3 + x.t);
        }
        lie::Mass inertia;
        lie::Rows rows_pattern;
    };
    const DuplicateRow system;
    lie::Saddle K(system);
    lie::State x;
    CHECK_THROWS_AS(K.assemble(x), lie::SingularMatrix);
    x.t = 1;
    CHECK_NOTHROW(K.assemble(x));
    x.t = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(K.assemble(x), lie::NonFinite);
    x.t = 0;
    CHECK_THROWS_AS(K.assemble(x), lie::SingularMatrix);
}

TEST_CASE("the reciprocal condition does not depend on the units of mass and length", "[lie][saddle]")
{
    struct Scaled final : lie::System {
        Scaled(double mass, double length) : length(length)
        {
            inertia.m = {mass};
            inertia.J_bar = {mass * length * length * Mat3(Vec3(1, 2, 2.5).asDiagonal())};
            rows_pattern.entry = {{}, {}, {}};
            rows_pattern.start = {0, 1, 2, 3};
        }
        const lie::Mass& mass() const override { return inertia; }
        const lie::Rows& pattern() const override { return rows_pattern; }
        void loads(const lie::State&, lie::Loads&) const override {}
        void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
        void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
        void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
        void variation(const lie::State&, lie::Rows& out) const override
        {
            for (int k = 0; k < 3; ++k) {
                out.entry[k].r = Vec3::Unit(k);
                out.entry[k].pi = length * Vec3(0.3, -1, 0.5).cross(Vec3::Unit(k));
            }
        }
        double length;
        lie::Mass inertia;
        lie::Rows rows_pattern;
    };
    const Scaled metres(1, 1), micrometres(1e-12, 1e-6);
    lie::Saddle K(metres), K_small(micrometres);
    K.assemble({});
    K_small.assemble({});
    CHECK(K_small.reciprocal_condition() == Approx(K.reciprocal_condition()).epsilon(1e-6));
}
