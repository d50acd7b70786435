// SPDX-License-Identifier: GPL-3.0-or-later
/// Algebraic variables: their elimination is compared with the full saddle system, and the motion of a bead
/// on a wire, with the parameter of the wire as its algebraic variable, with the closed form.

#include "lie/solver/elimination.hpp"
#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/linear_solver.hpp"
#include "lie/system.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <Eigen/LU>
#include <Eigen/QR>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// Random rows between bodies (-1: the ground), some with algebraic variables
class RandomGroups final : public lie::System {
public:
    /// last_free: number of rows at the end of a group without a body, such as surface equations
    struct Patch {
        int i, j, rows, unknowns, last_free;
    };

    RandomGroups(int bodies, const std::vector<Patch>& patches, unsigned seed) : random(seed)
    {
        for (int b = 0; b < bodies; ++b) {
            inertia.m.push_back(std::pow(10.0, random.number()));
            const Mat3 A = random.rotation();
            inertia.J_bar.push_back(A * Vec3(1, 2, 2.5).asDiagonal() * A.transpose());
        }
        int alpha = 0;
        for (const Patch& patch : patches) {
            if (patch.unknowns > 0) {
                values.algebraic.push_back({values.rows(), patch.rows, alpha, patch.unknowns, {}});
                lie::Rows::AlgebraicGroup& group = values.algebraic.back();
                group.D.resize(patch.rows, patch.unknowns);
                for (int k = 0; k < patch.rows; ++k)
                    for (int c = 0; c < patch.unknowns; ++c) group.D(k, c) = random.number();
                alpha += patch.unknowns;
            }
            for (int k = 0; k < patch.rows; ++k) {
                for (const int b : {patch.i, patch.j})
                    if (b >= 0 && k < patch.rows - patch.last_free)
                        values.entry.push_back(
                            {.body = b, .nonzero = 0b111111, .r = random.vector(), .pi = random.vector()});
                values.start.push_back(static_cast<int>(values.entry.size()));
            }
        }
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return values; }
    void loads(const lie::State&, lie::Loads&) const override {}
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const lie::State&, lie::Rows& out) const override { out = values; }

    lie::Rows values;

private:
    tests::Random random;
    lie::Mass inertia;
};

using Patches = std::vector<RandomGroups::Patch>;

struct Example {
    std::string name;
    int bodies;
    Patches patches;
};

std::vector<Example> examples()
{
    return {
        {"a contact with the ground", 1, {{0, -1, 7, 6, 2}}},
        {"a contact of two bodies", 2, {{0, 1, 7, 6, 2}}},
        {"two groups on the same bodies", 2, {{0, 1, 7, 6, 2}, {1, 0, 7, 6, 2}}},
        {"a group between ordinary rows", 3, {{-1, 0, 3, 0, 0}, {0, 1, 7, 6, 2}, {1, 2, 3, 0, 0}}},
        {"groups of different sizes",
         3,
         {{0, 1, 3, 1, 0}, {1, 2, 5, 2, 0}, {2, -1, 8, 7, 1}, {0, -1, 1, 0, 0}}},
        {"a chain of contacts", 6, {{-1, 0, 7, 6, 2}, {0, 1, 7, 6, 2}, {1, 2, 7, 6, 2}, {2, 3, 7, 6, 2}}},
    };
}

/// The dense saddle matrix, computed column by column
Eigen::MatrixXd dense_matrix(const lie::Saddle& K)
{
    Eigen::MatrixXd all(K.size(), K.size());
    Eigen::VectorXd column(K.size());
    for (int c = 0; c < K.size(); ++c) {
        K.multiply(Eigen::VectorXd::Unit(K.size(), c), column);
        all.col(c) = column;
    }
    return all;
}

}  // namespace

TEST_CASE("the saddle system has the same solution with and without elimination of algebraic variables",
          "[lie][saddle][massless]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u);
    for (const Example& c : examples()) {
        const RandomGroups system(c.bodies, c.patches, seed);
        lie::Saddle whole(system, lie::Metric::mass, lie::LinearSolver::klu),
            condensed(system, lie::Metric::mass, lie::LinearSolver::condensed),
            automatic(system, lie::Metric::mass, lie::LinearSolver::automatic);
        const Eigen::VectorXd z = Eigen::VectorXd::Random(whole.size());
        for (lie::Saddle* K : {&whole, &condensed, &automatic}) {
            INFO(c.name << ", solver "
                        << (K == &whole       ? "klu"
                            : K == &condensed ? "condensed"
                                              : "automatic"));
            K->assemble({});
            const Eigen::MatrixXd dense = dense_matrix(*K);
            CHECK((dense - dense.transpose()).norm() < 1e-15 * dense.norm());
            const double rounding = 1e-15 / dense.fullPivLu().rcond();
            Eigen::VectorXd b(K->size());
            K->multiply(z, b);  // f, g and p are not zero
            CHECK((b - dense * z).norm() < 1e-14 * dense.norm() * z.norm());
            Eigen::VectorXd solution = b;
            K->solve(solution);
            CHECK((solution - z).norm() < 100 * rounding * z.norm());

            Eigen::VectorXd only_g = Eigen::VectorXd::Zero(K->size());
            K->constraint_part(only_g) = K->constraint_part(b);
            const Eigen::VectorXd expected = dense.partialPivLu().solve(only_g);
            solution = b;  // f and p are not read
            K->solve_constraints(solution);
            CHECK((solution - expected).norm() < 100 * rounding * expected.norm());
        }
    }
}

TEST_CASE("the reduced rows are the projection of the rows onto the null space of D^T", "[lie][massless]")
{
    const unsigned seed = GENERATE(4u, 5u);
    for (const Example& c : examples()) {
        const RandomGroups system(c.bodies, c.patches, seed);
        lie::Elimination elimination(system.pattern(), std::vector<char>(system.rows(), 0));
        elimination.factor(system.values);
        const lie::Rows& reduced_rows = elimination.reduced();
        const auto dense = [&](const lie::Rows& rows) {
            Eigen::MatrixXd B = Eigen::MatrixXd::Zero(rows.rows(), 6 * c.bodies);
            for (int k = 0; k < rows.rows(); ++k)
                for (int e = rows.start[k]; e < rows.start[k + 1]; ++e)
                    B.block<1, 6>(k, 6 * rows.entry[e].body) << rows.entry[e].r.transpose(),
                        rows.entry[e].pi.transpose();
            return B;
        };
        const Eigen::MatrixXd B = dense(system.values), reduced = dense(reduced_rows);
        Eigen::MatrixXd D = Eigen::MatrixXd::Zero(system.rows(), system.pattern().algebraic_variables());
        for (const lie::Rows::AlgebraicGroup& g : system.values.algebraic)
            D.block(g.first, g.first_alpha, g.rows, g.count) = g.D;
        // P projects onto the null space of Dᵀ. With Zᵀ Z = I the reduced rows Zᵀ B satisfy (Zᵀ B)ᵀ (Zᵀ B) =
        // Bᵀ P B.
        const Eigen::MatrixXd P = Eigen::MatrixXd::Identity(system.rows(), system.rows()) -
                                  D * (D.transpose() * D).ldlt().solve(D.transpose());
        INFO(c.name);
        REQUIRE(reduced_rows.rows() == system.rows() - system.pattern().algebraic_variables());
        CHECK((reduced.transpose() * reduced - B.transpose() * P * B).norm() < 1e-10 * B.squaredNorm());
    }
}

TEST_CASE("algebraic variables that their rows do not determine throw an exception", "[lie][massless]")
{
    for (const int dependent : {0, 3, 5}) {
        RandomGroups system(1, {{0, -1, 7, 6, 2}}, 6);
        lie::Elimination elimination(system.pattern(), std::vector<char>(system.rows(), 0));
        CHECK_NOTHROW(elimination.factor(system.values));
        auto& D = system.values.algebraic[0].D;
        D.col(dependent) = D.col((dependent + 1) % 6) - 2 * D.col((dependent + 2) % 6);
        INFO("column " << dependent);
        CHECK_THROWS_AS(elimination.factor(system.values), lie::SingularMatrix);
        for (const lie::LinearSolver solver : {lie::LinearSolver::klu, lie::LinearSolver::condensed}) {
            lie::Saddle K(system, lie::Metric::mass, solver);
            CHECK_THROWS_AS(K.assemble({}), lie::SingularMatrix);
        }
        D.col(dependent).setZero();
        CHECK_THROWS_AS(elimination.factor(system.values), lie::SingularMatrix);
    }
}

namespace {

/// A bead on a wire of the form of a cycloid, r = c(α) = a (α + sin α, 1 - cos α) in a vertical plane: three
/// rows r - c(α) = 0 and one algebraic variable. The motion along the wire is harmonic at every amplitude
/// (Huygens):
///
///     s = 4a sin(α/2),    s̈ = -(g / 4a) s,    λ = F - m r̈
class Cycloid final : public lie::System {
public:
    Cycloid()
    {
        inertia.m = {0.7};
        inertia.J_bar = {Mat3::Identity()};
        for (int k = 0; k < 3; ++k) {
            rows_pattern.entry.push_back({.nonzero = 0b000111});
            rows_pattern.start.push_back(k + 1);
        }
        rows_pattern.algebraic.push_back({0, 3, 0, 1, Vec3::Zero()});
    }
    Vec3 in_plane(double along, double up) const { return along * direction + up * Vec3::UnitZ(); }
    Vec3 c(double alpha) const { return a * in_plane(alpha + std::sin(alpha), 1 - std::cos(alpha)); }
    Vec3 c_1(double alpha) const { return a * in_plane(1 + std::cos(alpha), std::sin(alpha)); }
    Vec3 c_2(double alpha) const { return a * in_plane(-std::sin(alpha), std::cos(alpha)); }

    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads& out) const override
    {
        out.F[0] = Vec3(0, 0, -g * inertia.m[0]);
        out.n_bar[0].setZero();
    }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out = x.body[0].r - c(x.alpha[0]);
    }
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        for (int k = 0; k < 3; ++k) out.entry[k].r = Vec3::Unit(k);
        out.algebraic[0].D = -c_1(x.alpha[0]);
    }
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        const Vec3 tangent = c_1(x.alpha[0]);
        const double alphadot = tangent.dot(x.body[0].rdot) / tangent.squaredNorm();
        out = alphadot * alphadot * c_2(x.alpha[0]);
    }
    void update_alpha(lie::State& x) const override
    {
        for (int k = 0; k < 20; ++k) {
            const Vec3 off = x.body[0].r - c(x.alpha[0]), tangent = c_1(x.alpha[0]);
            const double step = tangent.dot(off) / (tangent.squaredNorm() - off.dot(c_2(x.alpha[0])));
            x.alpha[0] += step;
            if (std::abs(step) < 1e-15) return;
        }
    }

    /// The exact motion whose velocity is zero at t = -0.3 s
    lie::State exact(double t) const
    {
        const double omega = std::sqrt(g / (4 * a)), phase = omega * (t + 0.3), s_0 = 0.8 * 4 * a;
        const double s = s_0 * std::cos(phase), sdot = -s_0 * omega * std::sin(phase);
        const double half = std::asin(s / (4 * a)), curvature = 1 / (4 * a * std::cos(half));
        const Vec3 tangent = in_plane(std::cos(half), std::sin(half)),
                   normal = in_plane(-std::sin(half), std::cos(half));
        lie::State x;
        x.t = t;
        x.body.resize(1);
        x.body[0].r = c(2 * half);
        x.body[0].rdot = sdot * tangent;
        x.body[0].rddot = -omega * omega * s * tangent + curvature * sdot * sdot * normal;
        x.alpha = Eigen::VectorXd::Constant(1, 2 * half);
        x.lambda = Vec3(0, 0, -g * inertia.m[0]) - inertia.m[0] * x.body[0].rddot;
        return x;
    }

private:
    static constexpr double a = 0.25, g = 9.81;
    const Vec3 direction = Vec3(0.6, 0.8, 0);
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

/// Largest errors over the nodes of 1.2 s
struct Errors final : lie::Observer {
    explicit Errors(const Cycloid& bead) : bead(bead) {}
    void accepted(const lie::State& x, long, int) override
    {
        const lie::State y = bead.exact(x.t);
        motion = std::max({motion, (x.body[0].r - y.body[0].r).norm(), std::abs(x.alpha[0] - y.alpha[0]),
                           (x.body[0].rdot - y.body[0].rdot).norm()});
        // The multipliers of the first nodes of implicit schemes have a larger error.
        if (x.t > 0.6) lambda = std::max(lambda, (x.lambda - y.lambda).norm());
        Eigen::VectorXd Phi(3);
        bead.phi(x, Phi);
        residual = std::max(residual, Phi.norm());
        bound = std::max(bound, std::abs(bead.c_1(x.alpha[0]).dot(x.lambda)));
    }
    const Cycloid& bead;
    double motion = 0, lambda = 0, residual = 0, bound = 0;
};

Errors errors(const lie::Scheme& scheme, const Cycloid& bead, double h)
{
    Errors worst(bead);
    lie::Observer* observers[] = {&worst};
    const auto integrator = scheme.make(bead, {.tolerance = 1e-14});
    lie::march(bead.exact(0), *integrator, lie::TimeGrid::over(1.2, h, 1.2), observers);
    return worst;
}

}  // namespace

TEST_CASE("a bead on a cycloid converges to the closed form with the declared order (long)",
          "[lie][order][massless]")
{
    const Cycloid bead;
    int schemes = 0;
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::algebraic)) continue;
        ++schemes;
        const double h = s.order > 5 ? 0.08 : s.order > 2 ? 2e-2 : 1e-3;
        const Errors coarse = errors(s, bead, h), fine = errors(s, bead, h / 2);
        const double of_motion = std::log2(coarse.motion / fine.motion),
                     of_lambda = std::log2(coarse.lambda / fine.lambda);
        INFO(s.name << " declares " << s.order << " and " << s.order_lambda << " for lambda, shows "
                    << of_motion << " and " << of_lambda << "; errors " << fine.motion << " and "
                    << fine.lambda << ", residual " << fine.residual);
        CHECK(of_motion == Approx(s.order).margin(s.order > 5 ? 0.2 : 0.1));
        CHECK(of_lambda == Approx(s.order_lambda).margin(0.2));
        CHECK(fine.residual < 1e-13);
        CHECK(fine.bound < 1e-11 * 7);  // Φ_αᵀ λ = 0; λ is about 7 N
    }
    CHECK(schemes >= 9);
}

TEST_CASE("a step with algebraic variables has the same result with both linear solvers",
          "[lie][condensed][massless]")
{
    const Cycloid bead;
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::algebraic)) continue;
        lie::State x = bead.exact(0), y = x;
        const auto klu = s.make(bead, {.linear_solver = lie::LinearSolver::klu}),
                   condensed = s.make(bead, {.linear_solver = lie::LinearSolver::condensed});
        INFO(s.name);
        for (int n = 0; n < 50; ++n) CHECK(klu->step(x, 5e-3) == condensed->step(y, 5e-3));
        CHECK((x.body[0].r - y.body[0].r).norm() < 1e-12);
        CHECK((x.alpha - y.alpha).norm() < 1e-12);
        CHECK((x.lambda - y.lambda).norm() < 1e-8 * x.lambda.norm());
    }
}

TEST_CASE("a step with algebraic variables does not allocate memory", "[lie][allocation][massless]")
{
    if (!tests::counts_allocations) {
        WARN("skipped: a sanitizer replaces the allocator");
        return;
    }
    const Cycloid bead;
    for (const lie::Scheme& s : lie::schemes())
        for (const lie::LinearSolver solver : {lie::LinearSolver::klu, lie::LinearSolver::condensed}) {
            if (!s.supports.contains(lie::Feature::algebraic)) continue;
            const auto integrator = s.make(bead, {.linear_solver = solver});
            lie::State x = bead.exact(0);
            for (int n = 0; n < 3; ++n) integrator->step(x, 1e-3);
            const long taken = tests::allocations_during([&] {
                for (int n = 0; n < 100; ++n) integrator->step(x, 1e-3);
            });
            INFO(s.name);
            CHECK(taken == 0);
        }
}

TEST_CASE("a scheme without support for algebraic variables names the schemes that support them",
          "[lie][massless]")
{
    const Cycloid bead;
    for (const lie::Scheme& s : lie::schemes()) {
        if (s.supports.contains(lie::Feature::algebraic)) {
            CHECK_NOTHROW(s.make(bead, {}));
            continue;
        }
        INFO(s.name);
        CHECK_THROWS_AS(s.make(bead, {}), lie::InvalidInput);
        CHECK_THROWS_WITH(s.make(bead, {}), Catch::StartsWith("integrator " + s.name) &&
                                                Catch::Contains("does not support evolving contacts") &&
                                                Catch::Contains("rA-half-1-momentum"));
    }
    CHECK_FALSE(lie::scheme("rA-full-1-exact").supports.contains(lie::Feature::algebraic));
}

TEST_CASE("rA-half-1-momentum conserves the angular momentum of a free body to rounding", "[lie][invariants]")
{
    const tests::SpinningTop top(true);
    struct Momentum final : lie::Observer {
        explicit Momentum(const Mat3& J_bar) : J_bar(J_bar) {}
        void accepted(const lie::State& x, long n, int) override
        {
            const Vec3 L = x.body[0].A * (J_bar * x.body[0].omega_bar);
            if (n == 0) first = L;
            drift = std::max(drift, (L - first).norm() / first.norm());
        }
        const Mat3 J_bar;
        Vec3 first = Vec3::Zero();
        double drift = 0;
    };
    const auto drift = [&](const char* scheme, long steps) {
        Momentum momentum(top.mass().J_bar[0]);
        lie::Observer* observers[] = {&momentum};
        const auto integrator = lie::scheme(scheme).make(top, {.tolerance = 1e-17});
        lie::march(top.start(), *integrator, lie::TimeGrid::over(2e-3 * double(steps), 2e-3, 1e3), observers);
        return momentum.drift;
    };
    // rounding errors accumulate as a random walk of about 3e-16 per step
    CHECK(drift("rA-half-1-momentum", 1000) < 1e-14);
    CHECK(drift("rA-half-1-momentum", 10000) < 5e-14);
    CHECK(drift("rA-half-1", 100) > 1e-6);
}
