// SPDX-License-Identifier: GPL-3.0-or-later Cone problems against fc3d of Siconos, which solves Coulomb's law
// by a nonsmooth Gauss-Seidel method. Built only if libsiconos-numerics is installed.
//
// ConeSolver::solve_coulomb() must agree always. The convex relaxation must agree if no contact slides: for μ
// = 0 and if friction is sufficient to stick. It differs for a sliding contact, which it separates.
#include "contact/scenes/dvi/cone_solver.hpp"
#include "contact/tangent_basis.hpp"
#include "tests/support/random_motion.hpp"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <catch2/catch.hpp>

using namespace hilda;
using contact::ConeProblem;
using contact::ConeSolver;
using lie::Mat3;
using lie::Vec3;
using tests::Random;

namespace {

/// Two layers of two bodies that fall on each other and on a fixed body; fall, slip [m/s]
ConeProblem falling(Random& random, int contacts, double mu, double fall, double slip)
{
    constexpr int bodies = 5;
    ConeProblem problem;
    std::vector<ConeProblem::Velocity> v(bodies);
    for (int b = 0; b + 1 < bodies; ++b) {
        const Mat3 A = random.rotation();
        const Vec3 J = Vec3(0.5, 0.5, 0.5) + random.vector(0.3);
        problem.body.push_back({1 / random.number(0.5, 2), A * J.asDiagonal() * A.transpose()});
        v[b].v = slip * random.vector() - Vec3(0, 0, fall * (bodies - b));
        v[b].omega = slip * random.vector();
    }
    problem.body.push_back({});
    for (int c = 0; c < contacts; ++c) {
        const int i = c % 4, j = i < 2 ? i + 2 : 4;  // the upper body first, the ground last
        const Vec3 n = (Vec3::UnitZ() + random.vector(0.4)).normalized();
        Mat3 frame;
        frame << n, contact::tangent_basis(n);
        const Vec3 below = Vec3(0, 0, -0.3) + random.vector(0.3);
        problem.contact.push_back({i, j, frame, below, -below, mu, Vec3::Zero()});
    }
    std::vector<Vec3> r;
    problem.relative_velocities(v, r);
    for (int c = 0; c < contacts; ++c) problem.contact[c].r = r[c];
    return problem;
}

struct Solution {
    Eigen::VectorXd gamma, u;
};

Solution by_siconos(const ConeProblem& problem)
{
    const int n = static_cast<int>(problem.contact.size());
    Eigen::MatrixXd W(3 * n, 3 * n);  // column-major, as required by fc3d
    Eigen::VectorXd q(3 * n);
    std::vector<double> mu(n);
    std::vector<ConeProblem::Velocity> v;
    std::vector<Vec3> column;
    for (int k = 0; k < 3 * n; ++k) {
        std::vector<Vec3> gamma(n, Vec3::Zero());
        gamma[k / 3][k % 3] = 1;
        problem.velocity_change(gamma, v);
        problem.relative_velocities(v, column);
        for (int c = 0; c < n; ++c) W.block<3, 1>(3 * c, k) = column[c];
    }
    for (int c = 0; c < n; ++c) {
        q.segment<3>(3 * c) = problem.contact[c].r;
        mu[c] = problem.contact[c].mu;
    }
    NumericsMatrix* M = NM_create_from_data(NM_DENSE, 3 * n, 3 * n, W.data());
    FrictionContactProblem* fc = frictionContactProblem_new();
    fc->dimension = 3;
    fc->numberOfContacts = n;
    fc->M = M;
    fc->q = q.data();
    fc->mu = mu.data();
    SolverOptions* options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
    options->dparam[SICONOS_DPARAM_TOL] = 1e-12;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 200000;
    Solution out{Eigen::VectorXd::Zero(3 * n), Eigen::VectorXd::Zero(3 * n)};
    const int failed = fc3d_driver(fc, out.gamma.data(), out.u.data(), options);
    solver_options_delete(options);
    // the data are ours: Siconos frees only its structures
    M->matrix0 = nullptr;
    NM_clear(M);
    free(M);
    free(fc);
    REQUIRE(failed == 0);
    out.u = W * out.gamma + q;
    return out;
}

Solution ours(ConeProblem problem, bool coulomb)
{
    ConeSolver solver;
    solver.tolerance = 1e-11;
    solver.max_iterations = 100000;
    std::vector<Vec3> gamma;
    std::vector<double> s;
    if (coulomb)
        solver.solve_coulomb(problem, gamma, s);
    else
        solver.solve(problem, gamma);
    Solution out{Eigen::VectorXd(3 * gamma.size()), Eigen::VectorXd(3 * gamma.size())};
    for (size_t c = 0; c < gamma.size(); ++c) {
        out.gamma.segment<3>(3 * c) = gamma[c];
        out.u.segment<3>(3 * c) = solver.velocities()[c];
    }
    return out;
}

double largest_slip(const Solution& s)
{
    double out = 0;
    for (int c = 0; 3 * c < s.u.size(); ++c)
        if (s.gamma[3 * c] > 1e-9) out = std::max(out, s.u.segment<2>(3 * c + 1).norm());
    return out;
}

}  // namespace

TEST_CASE("without friction the cone problem has the velocities and impulses of Siconos",
          "[contact][dvi][siconos]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
    const int contacts = GENERATE(1, 4, 8);
    Random random(seed);
    const ConeProblem problem = falling(random, contacts, 0, 1, 0.5);
    const Solution theirs = by_siconos(problem), relaxed = ours(problem, false);
    CHECK((theirs.u - relaxed.u).norm() < 1e-8);
    if (contacts <= 4) CHECK((theirs.gamma - relaxed.gamma).norm() < 1e-8);  // unique
}

TEST_CASE("if all contacts stick, the cone problem and Coulomb's law agree with Siconos",
          "[contact][dvi][siconos]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
    Random random(seed);
    const ConeProblem problem = falling(random, 4, 3, 1, 0.1);
    const Solution theirs = by_siconos(problem), relaxed = ours(problem, false), law = ours(problem, true);
    REQUIRE(largest_slip(theirs) < 1e-8);
    CHECK((theirs.u - relaxed.u).norm() < 1e-8);
    CHECK((theirs.gamma - relaxed.gamma).norm() < 1e-8);
    CHECK((theirs.gamma - law.gamma).norm() < 1e-8);
}

TEST_CASE("if contacts slide, Coulomb's law agrees with Siconos and the relaxation differs",
          "[contact][dvi][siconos]")
{
    const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
    const double mu = GENERATE(0.05, 0.1, 0.2, 0.4);
    Random random(seed);
    const ConeProblem problem = falling(random, 4, mu, 1, 1);
    const Solution theirs = by_siconos(problem), relaxed = ours(problem, false), law = ours(problem, true);
    REQUIRE(largest_slip(theirs) > 1e-2);
    CHECK((theirs.u - law.u).norm() < 1e-8);
    CHECK((theirs.gamma - law.gamma).norm() < 1e-8);
    // the relaxation separates the contact with μ |u_t|, which changes velocities by that amount
    const double difference = (theirs.u - relaxed.u).norm();
    CAPTURE(mu, largest_slip(relaxed), difference, difference / (mu * largest_slip(relaxed)));
    CHECK(difference > 0.1 * mu * largest_slip(relaxed));
    CHECK(difference < 5 * mu * largest_slip(relaxed));
}
