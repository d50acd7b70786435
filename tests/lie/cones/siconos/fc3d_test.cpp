// SPDX-License-Identifier: GPL-3.0-or-later
// lie::ConeSolver against fc3d of Siconos, which solves Coulomb's law by a nonsmooth Gauss-Seidel method.
// Built only if libsiconos-numerics is installed.
#include "lie/cones/cone_solver.hpp"
#include "tests/lie/cones/cone_problems.hpp"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <catch2/catch.hpp>

using namespace hilda;
using lie::ConeSolver;
using lie::Vec3;

namespace {

struct Solution {
    Eigen::VectorXd p, u;
};

Solution by_siconos(const tests::BodiesInContact& of)
{
    tests::Delassus d(of);  // column-major, as required by fc3d
    std::vector<double> mu = of.mu;
    const auto rows = static_cast<int>(d.r.size());
    NumericsMatrix* M = NM_create_from_data(NM_DENSE, rows, rows, d.W.data());
    FrictionContactProblem* fc = frictionContactProblem_new();
    fc->dimension = 3;
    fc->numberOfContacts = rows / 3;
    fc->M = M;
    fc->q = d.r.data();
    fc->mu = mu.data();
    SolverOptions* options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
    options->dparam[SICONOS_DPARAM_TOL] = 1e-12;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 200000;
    Solution out{Eigen::VectorXd::Zero(rows), Eigen::VectorXd::Zero(rows)};
    const int failed = fc3d_driver(fc, out.p.data(), out.u.data(), options);
    solver_options_delete(options);
    // the data are ours: Siconos frees only its structures
    M->matrix0 = nullptr;
    NM_clear(M);
    free(M);
    free(fc);
    REQUIRE(failed == 0);
    out.u = d.W * out.p + d.r;
    return out;
}

Solution ours(const tests::BodiesInContact& of)
{
    lie::ConeProblem problem = of.problem();
    ConeSolver solver(of.mass, of.rows);
    ConeSolver::Iterate x;
    x.p.assign(of.mu.size(), Vec3::Zero());
    solver.start(problem);
    REQUIRE(solver.solve(problem, x, {1e-12, 1e-12}).status == ConeSolver::Status::solved);
    Solution out{Eigen::VectorXd(3 * x.p.size()), Eigen::VectorXd(3 * x.p.size())};
    for (int c = 0; c < problem.contacts(); ++c) {
        out.p.segment<3>(3 * c) = x.p[static_cast<std::size_t>(c)];
        out.u.segment<3>(3 * c) = problem.u(c, x.y);
    }
    return out;
}

double largest_slip(const Solution& s)
{
    double out = 0;
    for (int c = 0; 3 * c < s.u.size(); ++c)
        if (s.p[3 * c] > 1e-9) out = std::max(out, s.u.segment<2>(3 * c + 1).norm());
    return out;
}

}  // namespace

TEST_CASE("without friction the cone problem has the velocities and impulses of Siconos", "[lie][siconos]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
    const int contacts = GENERATE(1, 4, 8);
    const tests::BodiesInContact of = tests::falling(seed, contacts, 0, 1, 0.5);
    const Solution theirs = by_siconos(of), mine = ours(of);
    CHECK((theirs.u - mine.u).norm() < 1e-8);
    if (contacts <= 4) CHECK((theirs.p - mine.p).norm() < 1e-8);  // unique
}

TEST_CASE("contact points that all stick have the impulses of Siconos", "[lie][siconos]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
    const tests::BodiesInContact of = tests::falling(seed, 4, 3, 1, 0.1);
    const Solution theirs = by_siconos(of), mine = ours(of);
    REQUIRE(largest_slip(theirs) < 1e-8);
    CHECK((theirs.u - mine.u).norm() < 1e-8);
    CHECK((theirs.p - mine.p).norm() < 1e-8);
}

TEST_CASE("contact points that slide have the impulses of Siconos", "[lie][siconos]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
    const double mu = GENERATE(0.05, 0.1, 0.2, 0.4);
    const tests::BodiesInContact of = tests::falling(seed, 4, mu, 1, 1);
    const Solution theirs = by_siconos(of), mine = ours(of);
    REQUIRE(largest_slip(theirs) > 1e-2);
    CHECK((theirs.u - mine.u).norm() < 1e-8);
    CHECK((theirs.p - mine.p).norm() < 1e-8);
}
