// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_islands.hpp"
#include "tests/lie/cones/cone_problems.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::ConeIslands;
using lie::ConeSolver;

namespace {

/// Both groups of bodies, without contact between them
tests::BodiesInContact together(const tests::BodiesInContact& a, const tests::BodiesInContact& b)
{
    tests::BodiesInContact all = a;
    const int first = static_cast<int>(a.mass.m.size());
    all.mass.m.insert(all.mass.m.end(), b.mass.m.begin(), b.mass.m.end());
    all.mass.J_bar.insert(all.mass.J_bar.end(), b.mass.J_bar.begin(), b.mass.J_bar.end());
    for (lie::ConeRows::Cone cone : b.cones) {
        cone.key = all.cones.size();
        cone.i += first;
        if (cone.j >= 0) cone.j += first;
        all.cones.push_back(cone);
    }
    all.mu.insert(all.mu.end(), b.mu.begin(), b.mu.end());
    for (int k = 0; k < b.rows.rows(); ++k) {
        for (int n = b.rows.start[k]; n < b.rows.start[k + 1]; ++n) {
            all.rows.entry.push_back(b.rows.entry[n]);
            all.rows.entry.back().body += first;
        }
        all.rows.start.push_back(static_cast<int>(all.rows.entry.size()));
    }
    all.v.resize(a.v.size() + b.v.size());
    all.v << a.v, b.v;
    return all;
}

template <class Solver, class Start>
ConeSolver::Iterate solve(Solver& solver, lie::ConeProblem& problem, const Start& start,
                          ConeSolver::Iterate x)
{
    x.p.resize(static_cast<std::size_t>(problem.contacts()), lie::Vec3::Zero());
    solver.start(problem);
    CHECK(solver.solve(problem, x, start, {.result = 1e-12}).status == ConeSolver::Status::solved);
    return x;
}

}  // namespace

TEST_CASE("the solutions of islands satisfy the whole problem, with and without joints", "[lie][cones]")
{
    auto of =
        together(together(tests::stack(3, 1, 0.1), tests::chain(4, 10, 0.1)), tests::stack(2, 5, 0.1, 3));
    of.add_box(1, {0.1, 0.1, 0.1});  // a body without contact
    const Eigen::VectorXd v = of.v;
    of.v.resize(v.size() + 6);
    of.v << v, lie::Vec3(1, 2, 3), lie::Vec3(4, 5, 6);
    lie::ConeProblem problem = of.problem();
    ConeIslands islands(of.mass, of.rows);
    const std::vector<double> start(of.cones.size(), 1e-12);
    const auto x = solve(islands, problem, start, {});
    CHECK(islands.islands() == 3);
    const Eigen::Index n = problem.q.size();
    CHECK(problem.residual(x) < 1e-8);
    CHECK(tests::violations(of, x.y, x.p).largest() < 1e-8);
    CHECK((x.y.segment<6>(n - 6) - of.v.tail<6>()).norm() < 1e-14);
    CHECK(problem.residual(x) == Approx(x.residual).margin(1e-12));
}

TEST_CASE("an island at rest needs no iteration, and the others those that they need alone", "[lie][cones]")
{
    const auto at_rest = tests::stack(4), moving = tests::stack(3, 1, 0.1);
    const auto both = together(at_rest, moving);
    lie::ConeProblem of_rest = at_rest.problem(), of_moving = moving.problem(), of_both = both.problem();
    ConeIslands rest(at_rest.mass, at_rest.rows), alone(moving.mass, moving.rows), all(both.mass, both.rows);
    const auto tolerances = [](const auto& of) { return std::vector<double>(of.cones.size(), 1e-10); };
    auto x = solve(rest, of_rest, tolerances(at_rest), {});
    const auto y = solve(alone, of_moving, tolerances(moving), {});
    const auto z = solve(all, of_both, tolerances(both), x);
    CHECK(all.islands() == 2);
    CHECK(all.iterations() == alone.iterations());
    CHECK(all.factorizations() == alone.factorizations());
    CHECK((z.y.tail(y.y.size()) - y.y).norm() == 0);
}

TEST_CASE("islands of the same bodies are solved again without allocation", "[lie][cones]")
{
    const auto of = together(tests::stack(3, 1, 0.1), tests::chain(4, 10, 0.1));
    lie::ConeProblem problem = of.problem();
    ConeIslands islands(of.mass, of.rows);
    const std::vector<double> start(of.cones.size(), 1e-12);
    auto x = solve(islands, problem, start, {});
    if (!tests::counts_allocations) return;
    CHECK(tests::allocations_during([&] {
              std::fill(x.p.begin(), x.p.end(), lie::Vec3::Zero());
              islands.start(problem);
              islands.solve(problem, x, start, {.result = 1e-12});
          }) == 0);
}
