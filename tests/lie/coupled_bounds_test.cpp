// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction of bodies that slide on each other: the compliance scales of all pairs together, and friction
/// that Coulomb's law does not determine.

#include "lie/coupled_bounds.hpp"

#include "io/message.hpp"
#include "lie/check.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/system.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace hilda;
using Eigen::Vector2d;
using lie::Vec3;

namespace {

constexpr double h = 1e-3, k_t = 1e5, c_t = 3;

/// Bodies that lie on each other and on the ground. Body b presses on the one below along (slope[b], 0, -1);
/// friction acts along x and y. Rotations about x and y are prevented.
class Pile : public lie::System {
public:
    Pile(std::vector<double> m, const std::vector<double>& slope, std::vector<double> mu)
        : slope(slope), mu(std::move(mu))
    {
        const int n = static_cast<int>(m.size());
        inertia.m = std::move(m);
        inertia.J_bar.assign(inertia.m.size(), Vec3(1, 2, 2.5).asDiagonal());
        for (int b = 0; b < n; ++b) {
            row(b, Vec3::Zero(), Vec3::UnitX());
            row(b, Vec3::Zero(), Vec3::UnitY());
            row(b, normal(b), Vec3::Zero());
        }
        for (int b = 0; b < n; ++b)
            for (const int along : {0, 1}) {
                C.regularised.push_back(C.rows());
                row(b, Vec3::Unit(along), Vec3::Zero());
            }
        C.unilateral = C.regularised;
        C.velocity_rows = 2 * n;
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return C; }
    void loads(const lie::State&, lie::Loads& out) const override
    {
        out.set_zero();
        for (size_t b = 0; b < force.size(); ++b) out.F[b] = force[b];
    }
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void variation(const lie::State&, lie::Rows& out) const override { out = C; }
    std::vector<lie::BoundedPair> bounded_pairs() const override
    {
        std::vector<lie::BoundedPair> pair(mu.size());
        for (size_t b = 0; b < mu.size(); ++b) {
            pair[b].first = C.regularised[2 * b];
            pair[b].normal_row = 3 * static_cast<int>(b);
            pair[b].n = Vec3::UnitZ();
            pair[b].K = k_t, pair[b].D = c_t, pair[b].mu = mu[b];
        }
        return pair;
    }
    void update_pairs(const lie::State&, std::vector<lie::BoundedPair>& out) const override
    {
        out = bounded_pairs();
    }
    std::string row_name(int k) const override { return "contact row " + std::to_string(k); }

    Vec3 normal(int b) const { return {slope[static_cast<size_t>(b)], 0, -1}; }

    std::vector<Vec3> force;

private:
    /// A row of the motion of body b relative to the one below
    void row(int b, const Vec3& r, const Vec3& pi)
    {
        C.entry.push_back({.body = b, .r = r, .pi = pi});
        if (b > 0 && pi.isZero()) C.entry.push_back({.body = b - 1, .r = -r, .pi = pi});
        C.start.push_back(static_cast<int>(C.entry.size()));
    }
    const std::vector<double> slope, mu;
    lie::Mass inertia;
    lie::Rows C;
};

/// A step of a pile with the velocities v at its beginning
struct Step {
    Step(const Pile& pile, const std::vector<Vec3>& v)
        : friction(pile), K(pile), z(Eigen::VectorXd::Zero(K.size())), b(z)
    {
        friction.start({}, h);
        K.assemble({}, friction.compliance());
        for (int i = 0; i < pile.bodies(); ++i) {
            const auto at = static_cast<size_t>(i);
            b.segment<3>(6 * i) = pile.mass().m[at] * h * v[at] + h * h * pile.force[at];
        }
        friction.set_right_side(K.constraint_part(b));
        solve();
    }
    void solve()
    {
        z = b;
        K.solve(z);
    }
    Vector2d force(const lie::BoundedPair& c) { return K.constraint_part(z).segment<2>(c.first) / (h * h); }
    double pressure(const lie::BoundedPair& c) { return K.constraint_part(z)[c.normal_row + 2] / (h * h); }
    Vector2d slip(int b) const
    {
        const Vec3 below = b > 0 ? Vec3(z.segment<3>(6 * (b - 1))) : Vec3::Zero();
        return (z.segment<3>(6 * b) - below).head<2>() / h;
    }

    lie::BoundedRows friction;
    lie::Saddle K;
    Eigen::VectorXd z, b;
};

struct ThreeBlocks : Pile {
    explicit ThreeBlocks(const std::vector<double>& mu) : Pile({3, 2, 0.5}, {0, 0.1, -0.3}, mu)
    {
        force = {Vec3(20, 0, -30), Vec3(-5, 3, -20), Vec3(0, 0, -5)};
    }
};
const std::vector<Vec3> moving = {{1, 0.3, 0}, {0.4, 0.8, -0.06}, {0.40001, 0.8, -0.06}};

/// Checks the law of each pair: it sticks with its spring and dashpot, or slips at its bound. Returns the
/// number that stick.
int check_law(const Pile& pile, Step& step)
{
    int stick = 0;
    const std::vector<lie::BoundedPair> pairs = pile.bounded_pairs();
    for (size_t n = 0; n < pairs.size(); ++n) {
        INFO("pair " << n);
        const Vector2d F = step.force(pairs[n]), elastic = (h * k_t + c_t) * step.slip(static_cast<int>(n));
        const double bound = pairs[n].mu * step.pressure(pairs[n]);
        CHECK(bound > 0);
        CHECK(F.dot(elastic) == Approx(F.norm() * elastic.norm()));  // against the slip
        if (F.norm() < bound * (1 - 1e-6)) {
            CHECK((F - elastic).norm() < 1e-8 * elastic.norm());
            ++stick;
        } else {
            CHECK(F.norm() == Approx(bound).epsilon(1e-7));
            CHECK(elastic.norm() > F.norm());
        }
    }
    return stick;
}

}  // namespace

TEST_CASE("the compliance scales of bodies on each other are found together", "[lie][bounded]")
{
    // coefficients of friction, number of pairs that stick
    using Case = std::pair<std::vector<double>, int>;
    const auto [mu, expected] = GENERATE(Case({0.3, 0.2, 0.5}, 1), Case({5, 4, 3}, 3),
                                         Case({0.1, 40, 0.02}, 1), Case({0.3, 0.2, 0.02}, 0));
    const ThreeBlocks pile(mu);
    Step step(pile, moving);
    const std::vector<lie::BoundedPair> pairs = pile.bounded_pairs();
    std::vector<double> p(3, 1.), floor(3), compliance;
    for (size_t n = 0; n < 3; ++n) floor[n] = 1e-9 * h * h * step.force(pairs[n]).norm();
    lie::CoupledBounds coupled;
    REQUIRE(coupled.solve(step.K, step.z, pairs, h, floor, p));
    for (size_t n = 0; n < 3; ++n) {
        CHECK(p[n] >= 1);
        compliance.insert(compliance.end(), 2, p[n] * pairs[n].mobility(h) / h);
    }
    step.K.refactor(compliance);
    step.solve();
    const auto stick = std::count_if(p.begin(), p.end(), [](double scale) { return scale < 1 + 1e-9; });
    CHECK(check_law(pile, step) == stick);
    CHECK(stick == expected);
}

TEST_CASE("the pairs of bodies on each other satisfy their bounds after the search of a step",
          "[lie][bounded]")
{
    const ThreeBlocks pile({0.3, 40, 0.02});
    Step step(pile, moving);
    int solved = 1;
    for (; !step.friction.within_bounds(step.K, step.z); ++solved) {
        REQUIRE(solved < 100);
        step.solve();
    }
    CHECK(solved > 2);
    CHECK(check_law(pile, step) == 1);
}

TEST_CASE("friction that grows its own normal force beyond the bound has no solution, and the row is named",
          "[lie][bounded]")
{
    // A force F along x on the slope -1 changes the normal force by F/2: self-locking from mu = 2
    const double mu = GENERATE(1.5, 3.);
    Pile pile({2}, {-1}, {mu});
    pile.force = {Vec3(0, 0, -20)};
    Step step(pile, {Vec3(1, 0, -1)});
    lie::CoupledBounds coupled;
    const double response = coupled.normal_response(step.K, pile.bounded_pairs()[0], Vector2d::UnitX());
    CHECK(response == Approx(0.5));
    const lie::BoundedPair pair = pile.bounded_pairs()[0];
    const double F = step.force(pair).norm(), error = std::abs(F - mu * step.pressure(pair)) / F;
    std::string expected = "dF = 1.5 times its bound, at least 1";
    if (mu < 2)
        expected = io::formatted(
            "not found in 0 solutions of the step; largest relative error of |F| = mu N %.3g", error);
    try {
        step.friction.fail(step.K, step.z);
    } catch (const lie::NumericalFailure& e) {
        CHECK(e.status == (mu < 2 ? "friction_not_converged" : "friction_has_no_solution"));
        CHECK_THAT(e.what(), Catch::StartsWith("contact row 3: ") && Catch::EndsWith(expected));
    }
}

TEST_CASE("a contact that would stop by an impulse starts without friction", "[lie][bounded]")
{
    // Sliding along x, the friction force -x presses the body on the slope -1 or lifts it from the slope 1
    const double mu = 3, slope = GENERATE(-1., 1.);
    Pile pile({2}, {slope}, {mu});
    pile.force = {Vec3(0, 0, -20)};
    lie::State x;
    x.body.resize(1);
    x.body[0].rdot = Vec3(1, 0, slope);  // along the slope
    lie::Saddle K(pile);
    lie::solve_accelerations(pile, K, x);
    const Vec3 a = x.body[0].rddot;
    CHECK(a.z() == Approx(slope * a.x()));
    const double N = x.lambda[2], F = x.lambda[3];
    CHECK(2 * a.x() + slope * N + F == Approx(0).margin(1e-6));
    INFO("slope " << slope << ": F = " << F << " N = " << N);
    if (slope == -1) {
        // 1e-9 of the force of 4 MN that would stop it within 1 us remains
        CHECK(F == Approx(0).margin(0.005));
        CHECK(N == Approx(10).epsilon(1e-3));  // 20 N/(1 + slope²)
    } else {
        CHECK(F == Approx(mu * N));
    }
}
