// SPDX-License-Identifier: GPL-3.0-or-later
/// Regularised rows with a bound on one body: the law of the pair, and the pivots of the saddle matrix.

#include "lie/bounded_rows.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

namespace {

/// A body that is pressed on a plane by a force: the rows 0 to 2 prevent the rotation about x and y and the
/// motion along z, the rows 3 and 4 are friction along x and y.
class PressedBody final : public lie::System {
public:
    PressedBody()
    {
        inertia.m = {2};
        inertia.J_bar = {Vec3(1, 2, 2.5).asDiagonal()};
        const auto row = [&](const Vec3& r, const Vec3& pi) {
            rows_pattern.entry.push_back({.body = 0, .nonzero = 0b111111, .r = r, .pi = pi});
            rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
        };
        row(Vec3::Zero(), Vec3::UnitX());
        row(Vec3::Zero(), Vec3::UnitY());
        row(-Vec3::UnitZ(), Vec3::Zero());
        row(Vec3::UnitX(), Vec3::Zero());
        row(Vec3::UnitY(), Vec3::Zero());
        rows_pattern.velocity_rows = 2;
        rows_pattern.regularised = rows_pattern.unilateral = {3, 4};
        pair.first = 3;
        pair.K = 1e4, pair.D = 3, pair.S = {1e-4, -2e-4}, pair.n = Vec3::UnitZ();
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads&) const override {}
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const lie::State&, lie::Rows& out) const override { out = rows_pattern; }
    std::vector<lie::BoundedPair> bounded_pairs() const override { return {pair}; }
    void update_pairs(const lie::State&, std::vector<lie::BoundedPair>& out) const override { out = {pair}; }

    lie::BoundedPair pair;

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

}  // namespace

TEST_CASE("a pair of bounded rows sticks with its spring and dashpot, or slips at its bound",
          "[lie][bounded]")
{
    const double mu = GENERATE(0., 0.2, 50.), h = 1e-3, F_N = 20;
    const Vec3 v_n(0.3, -0.1, 0), F(4, 1, -F_N);
    const auto solver = GENERATE(lie::LinearSolver::klu, lie::LinearSolver::condensed);
    PressedBody system;
    system.pair.mu = mu;
    lie::BoundedRows friction(system);
    lie::Saddle K(system, lie::Metric::mass, solver);
    friction.start({}, h);
    K.assemble({}, friction.compliance());
    Eigen::VectorXd b = Eigen::VectorXd::Zero(K.size()), z;  // z = (h v, h² λ)
    b.head<3>() = 2 * h * v_n + h * h * F;
    friction.set_right_side(K.constraint_part(b));
    int solved = 0;
    do {
        z = b;
        K.solve(z);
        REQUIRE(++solved < 20);
    } while (!friction.within_bounds(K, z));
    const Eigen::Vector2d v = z.head<2>() / h, lambda = K.constraint_part(z).tail<2>() / (h * h);
    const Eigen::Vector2d elastic =
        system.pair.K * (system.pair.S + h * v) + system.pair.D * v;  // without the bound
    INFO("mu = " << mu);
    CHECK(K.constraint_part(z)[2] / (h * h) == Approx(F_N));
    if (mu == 50) {
        CHECK((lambda - elastic).norm() < 1e-9 * elastic.norm());
        CHECK(solved == 1);
    } else {
        CHECK(std::abs(lambda.norm() - mu * F_N) < 1e-6 * (mu * F_N + elastic.norm()));
        CHECK(lambda.dot(elastic) == Approx(lambda.norm() * elastic.norm()));
        CHECK(solved > 1);
    }
}

TEST_CASE("an inactive pair has no force and no bound", "[lie][bounded]")
{
    PressedBody system;
    system.pair.K = 0;
    lie::BoundedRows friction(system);
    friction.start({}, 1e-3);
    CHECK(friction.compliance() == std::vector<double>{0, 0});
    lie::Saddle K(system);
    K.assemble({});  // without compliances the rows are inactive
    Eigen::VectorXd z = Eigen::VectorXd::Ones(K.size());
    K.solve(z);
    CHECK(friction.within_bounds(K, z));
}

TEST_CASE("pivots chosen for other compliances are those of the state of the last assembly", "[lie][bounded]")
{
    const PressedBody system;
    lie::Saddle K(system, lie::Metric::mass, lie::LinearSolver::klu);
    lie::State x;
    for (const double t : {1., 2.}) {
        x.t = t;
        K.assemble(x, std::vector<double>{1e-3, 1e-3});
    }
    CHECK(K.pivots().t == 1);
    CHECK(K.factorizations() == 1);
    x.t = 3;  // an iterate
    K.refactor(std::vector<double>{1e9, 1e9});
    CHECK(K.factorizations() == 2);
    CHECK(K.pivots().t == 2);
}
