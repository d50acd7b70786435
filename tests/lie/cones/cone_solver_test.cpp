// SPDX-License-Identifier: GPL-3.0-or-later
/// The solver of the cone problem on stacks, columns and chains with mass ratios of 10⁴.

#include "lie/cones/cone_solver.hpp"
#include "tests/lie/cones/cone_problems.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::ConeSolver;
using lie::Mat3;
using lie::Vec3;

namespace {

struct Named {
    const char* name;
    tests::BodiesInContact of;
};

std::vector<Named> problems()
{
    return {{"stack of 10", tests::stack(10)},
            {"stack of 10, random velocities", tests::stack(10, 1, 0.1)},
            {"stack of 10, top 1e4 kg", tests::stack(10, 1e4)},
            {"column of 100 spheres", tests::column_of_spheres(100)},
            {"chain of 50, random velocities", tests::chain(50, 1, 0.1)},
            {"chain of 50, end 1e4 kg", tests::chain(50, 1e4, 0.1)},
            {"20 links with 1e4 kg on 1 kg", tests::hanging_load(20, 1e4)}};
}

/// The solution from p = 0
ConeSolver::Iterate solution(const tests::BodiesInContact& of)
{
    lie::ConeProblem p = of.problem();
    ConeSolver solver(of.mass, of.rows);
    ConeSolver::Iterate x;
    x.p.assign(p.mu.size(), Vec3::Zero());
    solver.start(p);
    CHECK(solver.solve(p, x, {1e-12, 1e-12}).status == ConeSolver::Status::solved);
    return x;
}

/// Independent solution of Coulomb's law: block Gauss-Seidel with W as a matrix, the rows of a contact point
/// by projected gradients
Eigen::VectorXd gauss_seidel(const tests::Delassus& of, double mu)
{
    Eigen::VectorXd p = Eigen::VectorXd::Zero(of.r.size());
    for (int sweep = 0; sweep < 8000; ++sweep) {
        double moved = 0;
        for (int c = 0; 3 * c < p.size(); ++c) {
            const Mat3 W_cc = of.W.block<3, 3>(3 * c, 3 * c);
            const Vec3 before = p.segment<3>(3 * c);
            const Vec3 others = of.r.segment<3>(3 * c) + of.W.middleRows<3>(3 * c) * p - W_cc * before;
            Vec3 now = before;
            for (int k = 0; k < 30; ++k) {
                Vec3 u = W_cc * now + others;
                u[0] += mu * lie::tangential(u);
                now = lie::project_on_cone(now - u / W_cc.norm(), mu);
            }
            p.segment<3>(3 * c) = now;
            moved = std::max(moved, (now - before).norm());
        }
        if (moved < 1e-13) break;
    }
    return p;
}

}  // namespace

TEST_CASE("one contact point has the closed-form impulses of sticking, sliding and separation",
          "[lie][cones]")
{
    // a body of 2 kg that touches at its centre of mass
    const double m = 2, mu = 0.5;
    const auto impulse = [&](const Vec3& u, double of_mu) -> Vec3 {  // u = (u_n, u_t) without contact
        tests::BodiesInContact of;
        of.add_box(m, {0.1, 0.1, 0.1});
        of.add_contact(0, -1, Vec3::Zero(), Vec3::Zero(), of_mu);
        of.v.setZero(6);
        of.v.head<3>() = of.cones[0].axes * u;
        return solution(of).p[0];
    };
    CHECK((impulse({-1, 0.3, 0.4}, mu) - m * Vec3(1, -0.3, -0.4)).norm() < 1e-11);  // sticks
    CHECK((impulse({-1, 3, 4}, mu) - m * Vec3(1, -0.3, -0.4)).norm() < 1e-11);      // slides: u_n = 0
    for (const double of_mu : {0., 1e-300, 1e-8, 0.3, 1e8}) {
        INFO("mu " << of_mu);
        CHECK(impulse({0.6, 0.3, 0.4}, of_mu) == Vec3::Zero());  // separates
        CHECK(impulse({0.6, 0, 0}, of_mu) == Vec3::Zero());
    }
    CHECK((impulse({-1, 3, 4}, 0) - m * Vec3(1, 0, 0)).norm() < 1e-11);
}

TEST_CASE("random contact points satisfy Coulomb's law with the velocities of Gauss-Seidel", "[lie][cones]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u);
    for (const double mu : {0., 0.2, 1.})
        for (const int contacts : {1, 4, 8}) {
            INFO("mu " << mu << ", " << contacts << " contact points");
            const tests::BodiesInContact of = tests::falling(seed, contacts, mu, 1, 0.5);
            const ConeSolver::Iterate x = solution(of);
            CHECK(tests::violations(of, x.y, x.p).largest() < 1e-9);
            const tests::Delassus u(of);
            Eigen::VectorXd p(3 * contacts);
            for (int c = 0; c < contacts; ++c) p.segment<3>(3 * c) = x.p[c];
            // With several contact points the impulses are not unique, and with large coefficients of
            // friction the velocities are not either.
            if (mu < 1 || contacts == 1) CHECK((u.W * (p - gauss_seidel(u, mu))).norm() < 1e-8);
        }
}

TEST_CASE("impulses are proportional to the masses", "[lie][cones]")
{
    const double factor = 0x1p-20;  // a power of two, so that scaling does not round
    const tests::BodiesInContact of = tests::falling(8, 6, 0.5, 1, 0.5);
    tests::BodiesInContact scaled = of;
    for (double& m : scaled.mass.m) m *= factor;
    for (Mat3& J : scaled.mass.J_bar) J *= factor;
    const ConeSolver::Iterate x = solution(of), y = solution(scaled);
    for (std::size_t c = 0; c < x.p.size(); ++c) CHECK((y.p[c] / factor - x.p[c]).norm() < 1e-11);
}

TEST_CASE("the conditions of the contact law hold for stacks and chains with large mass ratios",
          "[lie][cones]")
{
    for (const Named& problem : problems()) {
        INFO(problem.name);
        lie::ConeProblem p = problem.of.problem();
        ConeSolver solver(problem.of.mass, problem.of.rows);
        ConeSolver::Iterate x;
        x.p.assign(p.mu.size(), Vec3::Zero());
        solver.start(p);
        const ConeSolver::Outcome cold = solver.solve(p, x, {1e-11, 1e-11});
        CHECK(cold.status == ConeSolver::Status::solved);
        CHECK(cold.residual < 1e-8);
        CHECK(solver.factorizations() <= 40);
        const tests::Violations of = tests::violations(problem.of, x.y, x.p);
        CHECK(of.momentum < 1e-8);
        CHECK(of.joints < 1e-12);
        CHECK(of.impulse < 1e-8);
        CHECK(of.velocity < 1e-8);
        CHECK(of.power < 1e-4);

        const long before = solver.factorizations();
        solver.start(p);
        CHECK(solver.solve(p, x, {1e-9, 1e-9}).status == ConeSolver::Status::solved);
        CHECK(solver.factorizations() - before <= 5);
    }
}

TEST_CASE("stacks with random velocities are solved from a cold start, or reported as relaxed (long)",
          "[lie][cones]")
{
    // violent sliding of ten boxes, with equal masses and with a top box of 1e4 kg
    int relaxed = 0;
    for (unsigned seed = 1; seed <= 20; ++seed)
        for (const double top : {1., 1e4}) {
            const tests::BodiesInContact of = tests::stack(10, top, 0.1, seed);
            lie::ConeProblem p = of.problem();
            ConeSolver solver(of.mass, of.rows);
            ConeSolver::Iterate x;
            x.p.assign(p.mu.size(), Vec3::Zero());
            solver.start(p);
            const ConeSolver::Outcome outcome = solver.solve(p, x, {1e-11, 1e-11});
            INFO("seed " << seed << ", top " << top << ", residual " << outcome.residual);
            CHECK(outcome.status != ConeSolver::Status::failed);
            const tests::Violations violated = tests::violations(of, x.y, x.p);
            CHECK(violated.momentum < 1e-6);
            CHECK(violated.impulse < 1e-6);
            if (outcome.status == ConeSolver::Status::friction_relaxed)
                ++relaxed;
            else
                CHECK(std::max(violated.velocity, violated.power) < 1e-4);
        }
    CHECK(relaxed <= 1);
}
