// SPDX-License-Identifier: GPL-3.0-or-later
// Friction cones and cone problems.
#include "contact/scenes/dvi/cone_solver.hpp"
#include "contact/tangent_basis.hpp"
#include "tests/support/random_motion.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

using namespace hilda;
using contact::ConeProblem;
using contact::ConeSolver;
using contact::project_on_cone;
using lie::Mat3;
using lie::Vec3;
using tests::Random;

namespace {

bool in_cone(const Vec3& gamma, double mu, double rounding)
{
    return std::hypot(gamma[1], gamma[2]) <= mu * gamma[0] + rounding;
}

/// u_n ≥ μ |u_t|
bool in_dual_cone(const Vec3& u, double mu, double rounding)
{
    return mu * std::hypot(u[1], u[2]) <= u[0] + rounding;
}

}  // namespace

TEST_CASE("the projection on a cone is the nearest point of the cone", "[contact][dvi][cone]")
{
    Random random(1);
    for (const double mu : {0., 0.2, 0.7, 2.}) {
        for (int k = 0; k < 40; ++k) {
            const Vec3 gamma = random.vector();
            const Vec3 at = project_on_cone(gamma, mu);
            CHECK(in_cone(at, mu, 1e-15));
            double nearest = gamma.norm();  // to the apex
            for (int n = 0; n <= 100; ++n)
                for (int a = 0; a < 30; ++a) {
                    const double height = 0.03 * n, angle = a * std::numbers::pi / 15;
                    const double side = mu * height;
                    nearest = std::min(
                        nearest,
                        (gamma - Vec3(height, side * std::cos(angle), side * std::sin(angle))).norm());
                }
            const double distance = (gamma - at).norm();
            if (in_cone(gamma, mu, 0))
                CHECK(distance == 0);
            else {
                CHECK(distance <= nearest * (1 + 1e-14));
                CHECK(distance > nearest - 0.2);  // spacing of the search grid
            }
        }
    }
}

TEST_CASE("the projection on a cone is idempotent and nonexpansive with a remainder in the polar cone",
          "[contact][dvi][cone]")
{
    Random random(2);
    for (const double mu : {0., 1e-8, 0.3, 1., 5.}) {
        for (int k = 0; k < 200; ++k) {
            const Vec3 a = random.vector(3), b = random.vector(3);
            const Vec3 on_a = project_on_cone(a, mu), on_b = project_on_cone(b, mu);
            CHECK((project_on_cone(on_a, mu) - on_a).norm() <= 1e-15 * a.norm());
            CHECK((on_a - on_b).norm() <= (a - b).norm() * (1 + 1e-14));
            // Moreau decomposition: a is the sum of its projections on the cone and on the polar cone, which
            // are orthogonal
            const Vec3 rest = a - on_a;
            CHECK(in_dual_cone(-rest, mu, 1e-14 * (1 + mu)));
            CHECK(std::abs(rest.dot(on_a)) <= 1e-14 * a.squaredNorm());
            CHECK((project_on_cone(2.5 * a, mu) - 2.5 * on_a).norm() <= 1e-14 * a.norm());
        }
    }
    CHECK(project_on_cone(Vec3::Zero(), 0.3) == Vec3::Zero());
    CHECK(project_on_cone(Vec3(0.5, 3, 4), 0) == Vec3(0.5, 0, 0));
    CHECK(project_on_cone(Vec3(-0.5, 3, 4), 0) == Vec3::Zero());
    CHECK(project_on_cone(Vec3(2, 3, 4), 2.5) == Vec3(2, 3, 4));
    for (const double mu :
         {0., 1e-300, 1e-8, 0.3, 1e8}) {  // on the axis of the cone, with both signs of zero
        INFO("mu " << mu);
        for (const double zero : {0., -0.}) {
            CHECK(project_on_cone(Vec3(-0.5, zero, -zero), mu) == Vec3::Zero());
            CHECK(project_on_cone(Vec3(0.5, zero, -zero), mu) == Vec3(0.5, 0, 0));
            CHECK(project_on_cone(Vec3(zero, 0, zero), mu) == Vec3::Zero());
        }
    }
}

namespace {

/// Bodies of different inertia, the last one fixed, with random contacts between them. r follows from body
/// velocities and gaps. With an arbitrary r the contacts can be incompatible, and then there is no minimum.
ConeProblem random_problem(Random& random, int bodies, int contacts, double mu)
{
    ConeProblem problem;
    for (int b = 0; b + 1 < bodies; ++b) {
        const Mat3 A = random.rotation();
        const Vec3 J = Vec3(1.5, 1.5, 1.5) + random.vector(1);
        problem.body.push_back({1 / random.number(0.5, 2), A * J.asDiagonal() * A.transpose()});
    }
    problem.body.push_back({});
    for (int c = 0; c < contacts; ++c) {
        const int i = c % (bodies - 1), j = i + 1 + c % (bodies - 1 - i);
        const Vec3 n = random.unit();
        Mat3 frame;
        frame << n, contact::tangent_basis(n);
        problem.contact.push_back({i, j, frame, random.vector(), random.vector(), mu, Vec3::Zero()});
    }
    std::vector<ConeProblem::Velocity> v(bodies);
    for (int b = 0; b + 1 < bodies; ++b) v[b] = {random.vector(), random.vector()};
    std::vector<Vec3> r;
    problem.relative_velocities(v, r);
    for (int c = 0; c < contacts; ++c) problem.contact[c].r = r[c] + random.number(0, 0.1) * Vec3::UnitX();
    return problem;
}

/// N, column by column
Eigen::MatrixXd delassus(const ConeProblem& problem)
{
    const int n = static_cast<int>(problem.contact.size());
    Eigen::MatrixXd N(3 * n, 3 * n);
    std::vector<ConeProblem::Velocity> v;
    std::vector<Vec3> u;
    for (int k = 0; k < 3 * n; ++k) {
        std::vector<Vec3> gamma(n, Vec3::Zero());
        gamma[k / 3][k % 3] = 1;
        problem.velocity_change(gamma, v);
        problem.relative_velocities(v, u);
        for (int c = 0; c < n; ++c) N.block<3, 1>(3 * c, k) = u[c];
    }
    return N;
}

Eigen::VectorXd stacked(const std::vector<Vec3>& x)
{
    Eigen::VectorXd out(3 * x.size());
    for (size_t c = 0; c < x.size(); ++c) out.segment<3>(3 * c) = x[c];
    return out;
}

Eigen::VectorXd right_side(const ConeProblem& problem)
{
    std::vector<Vec3> r;
    for (const auto& c : problem.contact) r.push_back(c.r);
    return stacked(r);
}

/// Independent solution: block Gauss-Seidel with N as a matrix; the three rows of a contact by projected
/// gradients
Eigen::VectorXd gauss_seidel(const ConeProblem& problem)
{
    const Eigen::MatrixXd N = delassus(problem);
    const Eigen::VectorXd r = right_side(problem);
    Eigen::VectorXd gamma = Eigen::VectorXd::Zero(r.size());
    for (int sweep = 0; sweep < 8000; ++sweep) {
        double moved = 0;
        for (int c = 0; 3 * c < r.size(); ++c) {
            const Mat3 N_cc = N.block<3, 3>(3 * c, 3 * c);
            const Vec3 previous = gamma.segment<3>(3 * c);
            const Vec3 others = r.segment<3>(3 * c) + N.middleRows<3>(3 * c) * gamma - N_cc * previous;
            Vec3 now = previous;
            for (int k = 0; k < 30; ++k)
                now = project_on_cone(now - (N_cc * now + others) / N_cc.norm(), problem.contact[c].mu);
            gamma.segment<3>(3 * c) = now;
            moved = std::max(moved, (now - previous).norm());
        }
        if (moved < 1e-12) break;
    }
    return gamma;
}

}  // namespace

TEST_CASE("the matrix-free N is symmetric and positive semidefinite and has the declared diagonal blocks",
          "[contact][dvi][solver]")
{
    Random random(3);
    const ConeProblem problem = random_problem(random, 5, 9, 0.4);
    const Eigen::MatrixXd N = delassus(problem);
    CHECK((N - N.transpose()).norm() < 1e-14 * N.norm());
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(N).eigenvalues().minCoeff() > -1e-13);
    for (int c = 0; c < 9; ++c) {
        const auto [i, j] = problem.block(problem.contact[c]);
        CHECK((N.block<3, 3>(3 * c, 3 * c) - i - j).norm() < 1e-14 * N.norm());
    }
}

TEST_CASE(
    "the solution of a cone problem satisfies the optimality conditions and equals that of Gauss-Seidel",
    "[contact][dvi][solver]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u);
    const double mu = GENERATE(0., 0.3, 1.);
    Random random(seed);
    // few contacts: N is regular and γ is unique; many contacts: only u is unique
    const int contacts = GENERATE(1, 4, 8);
    const ConeProblem problem = random_problem(random, 4, contacts, mu);
    ConeSolver solver;
    solver.tolerance = 1e-11;
    std::vector<Vec3> gamma;
    const auto out = solver.solve(problem, gamma);
    INFO(contacts << " contacts, mu " << mu << ": " << out.iterations << " iterations");
    CHECK(out.residual <= 1e-11);

    const Eigen::MatrixXd N = delassus(problem);
    const Eigen::VectorXd r = right_side(problem), u = N * stacked(gamma) + r;
    CHECK((u - stacked(solver.velocities())).norm() < 1e-12);
    for (int c = 0; c < contacts; ++c) {
        const Vec3 u_c = u.segment<3>(3 * c);
        CHECK(in_cone(gamma[c], mu, 1e-14));
        CHECK(in_dual_cone(u_c, mu, 1e-10));
        CHECK(std::abs(gamma[c].dot(u_c)) < 1e-10);
    }
    const Eigen::VectorXd other = gauss_seidel(problem);
    CHECK((N * other + r - u).norm() < 1e-8);
    const auto value = [&](const Eigen::VectorXd& x) { return 0.5 * x.dot(N * x) + r.dot(x); };
    CHECK(value(stacked(gamma)) == Approx(value(other)).margin(1e-10));
    if (contacts == 1) CHECK((other - stacked(gamma)).norm() < 1e-10);
}

TEST_CASE("one contact has the closed-form impulses of sticking, sliding and separation",
          "[contact][dvi][solver]")
{
    // a point mass on the ground: N = I/m
    const double m = 2, mu = 0.5;
    ConeProblem problem;
    problem.body = {{1 / m, Mat3::Zero()}, {}};
    problem.contact.push_back({0, 1, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), mu, Vec3::Zero()});
    ConeSolver solver;
    solver.tolerance = 1e-13;
    std::vector<Vec3> gamma;
    std::vector<double> s;
    const auto solution = [&](const Vec3& r, bool coulomb) -> Vec3 {
        problem.contact[0].r = r;
        gamma.assign(1, Vec3::Zero());
        s.assign(1, 0);
        if (coulomb)
            solver.solve_coulomb(problem, gamma, s);
        else
            solver.solve(problem, gamma);
        return gamma[0];
    };
    for (const bool coulomb : {false, true}) {
        CHECK((solution({-1, 0.3, 0.4}, coulomb) - m * Vec3(1, -0.3, -0.4)).norm() < 1e-12);  // sticking
        CHECK(solution({0.6, 0.3, 0.4}, coulomb) == Vec3::Zero());                            // separation
    }
    // sliding: u_n = 0 and γ_t = -μ γ_n t by Coulomb's law; u_n = μ |u_t| by the relaxation
    CHECK((solution({-1, 3, 4}, true) - m * Vec3(1, -0.3, -0.4)).norm() < 1e-12);
    CHECK(s[0] == Approx(5 - mu).epsilon(1e-12));
    CHECK(problem.contact[0].r == Vec3(-1, 3, 4));
    const double relaxed = m * (1 + mu * 5) / (1 + mu * mu);
    CHECK((solution({-1, 3, 4}, false) - relaxed * Vec3(1, -0.3, -0.4)).norm() < 1e-12);
    CHECK(solver.velocities()[0][0] ==
          Approx(mu * std::hypot(solver.velocities()[0][1], solver.velocities()[0][2])).epsilon(1e-11));
}

TEST_CASE("the fixed point solves Coulomb's law where the cone problem relaxes it", "[contact][dvi][solver]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u, 6u);
    const double mu = GENERATE(0.1, 0.5);
    Random random(seed);
    ConeProblem problem = random_problem(random, 4, 5, mu);
    ConeSolver solver;
    solver.tolerance = 1e-12;
    std::vector<Vec3> gamma;
    std::vector<double> s;
    const auto out = solver.solve_coulomb(problem, gamma, s);
    INFO(out.passes << " passes, " << out.iterations << " iterations");
    const Eigen::VectorXd u = delassus(problem) * stacked(gamma) + right_side(problem);
    for (int c = 0; c < 5; ++c) {
        const Vec3 u_c = u.segment<3>(3 * c);
        const double slip = std::hypot(u_c[1], u_c[2]);
        CHECK(s[c] == Approx(slip).margin(1e-11));
        CHECK(in_cone(gamma[c], mu, 1e-14));
        CHECK(u_c[0] > -1e-11);  // Signorini
        CHECK(std::abs(u_c[0] * gamma[c][0]) < 1e-11);
        const Vec3 against(0, u_c[1], u_c[2]);  // friction opposes the slip and is at its bound
        if (slip > 1e-9)
            CHECK((slip * Vec3(0, gamma[c][1], gamma[c][2]) + mu * gamma[c][0] * against).norm() < 1e-10);
    }
}

TEST_CASE("the solver reports the residual at its iteration limit and rejects a contact of fixed bodies",
          "[contact][dvi][solver]")
{
    Random random(7);
    ConeProblem problem = random_problem(random, 4, 12, 0.5);
    ConeSolver solver;
    solver.max_iterations = 3;
    std::vector<Vec3> gamma;
    try {
        solver.solve(problem, gamma);
        FAIL("three iterations are not enough");
    } catch (const contact::ConeNoConvergence& e) {
        CHECK(e.status == "cone_not_converged");
        CHECK(e.iterations == 3);
        CHECK(e.residual > 1e-8);
        CHECK_THAT(e.what(), Catch::StartsWith("contact::ConeSolver: the cone problem of 12 contacts did not "
                                               "converge: residual "));
    }
    problem.contact[0].i = problem.contact[0].j = 3;
    CHECK_THROWS_AS(solver.solve(problem, gamma), lie::InvalidInput);
}

TEST_CASE("impulses do not depend on the units of mass and length", "[contact][dvi][solver]")
{
    Random random(8);
    const ConeProblem problem = random_problem(random, 4, 6, 0.5);
    ConeProblem scaled = problem;
    const double mass = 0x1p-20, length = 0x1p10;  // powers of two, so that scaling does not round
    for (auto& b : scaled.body) b.m_inverse /= mass, b.J_inverse /= mass * length * length;
    for (auto& c : scaled.contact) c.s_i *= length, c.s_j *= length, c.r *= length;
    ConeSolver solver;
    std::vector<Vec3> gamma, of_scaled;
    solver.tolerance = 1e-10;
    const int iterations = solver.solve(problem, gamma).iterations;
    solver.tolerance *= length;
    CHECK(solver.solve(scaled, of_scaled).iterations == iterations);
    for (int c = 0; c < 6; ++c) CHECK(of_scaled[c] / (mass * length) == gamma[c]);
}
