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

}  // namespace

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
