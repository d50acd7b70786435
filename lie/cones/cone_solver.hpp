// SPDX-License-Identifier: GPL-3.0-or-later
/// Solver of the cone problem with Coulomb's law.
///
/// 1. Start: the given impulses, e.g. those of the last step, with the velocities that they cause. Contacts
///    at rest or in steady sliding need no more than this.
/// 2. ADMM with Anderson acceleration, up to 300 iterations.
/// 3. A few steps of the proximal Newton method for Coulomb's law from the result of 2.
/// 4. The same with larger proximal terms, which are reduced slowly: up to 400 factorisations.
/// 5. ADMM with up to 3000 iterations, then again with acceleration, each followed by 4.
/// 6. Newton's method from the solution of the convex problem without slip terms, by the interior point
///    method.
/// 7. Up to 20 passes of the fixed point s ← μ |u_t| of the convex problems, with Anderson
///    acceleration.
///
/// The result is the iterate with the smallest residual. The methods end at 5·10⁻³ of the acceptable
/// residual; the tolerance of 4 grows to 0.9 of it. Method 4 is left out below 10⁻¹ of the acceptable
/// residual, and those from 5 on below 0.9 of it. A result above the acceptable residual is an error, unless
/// the convex problem with the last slip terms is solved: the result then satisfies the law with a slip term
/// that differs from μ |u_t| (friction_relaxed).

#pragma once

#include "lie/cones/body_matrix.hpp"
#include "lie/cones/cone_admm.hpp"
#include "lie/cones/cone_interior_point.hpp"
#include "lie/cones/cone_newton.hpp"
#include "lie/cones/cone_problem.hpp"

#include <vector>

namespace hilda::lie {

class ConeSolver {
public:
    using Iterate = ConeProblem::Iterate;

    enum class Status { solved, friction_relaxed, failed };

    struct Outcome {
        Status status = Status::solved;
        double residual = 0;  ///< [m/s; rad/s]
        int worst = -1;       ///< contact point with the largest residual
    };

    ConeSolver(const Mass& mass, const Rows& pattern);

    /// Factors the matrix of the joints for the rows of the problem. Called once before solve() for each
    /// configuration.
    void start(ConeProblem& problem);
    /// y = (v, λ) for the impulses p. The velocities without contacts are those for p = 0.
    void set_velocities(const ConeProblem& problem, Iterate& x);
    /// Residuals [m/s]
    struct Tolerances {
        double start = 0;   ///< of the impulses of x that are taken as they are
        double result = 0;  ///< of ADMM
        double acceptable = 1e-6;
    };
    /// Solves the problem from the impulses of x, one for each contact point, to the tolerances or to
    /// rounding errors. Sets x.
    Outcome solve(const ConeProblem& problem, Iterate& x, const Tolerances& to);

    long iterations() const { return count; }  ///< of all methods
    long factorizations() const { return joints.factorizations() + matrix.factorizations(); }

private:
    void solve_by_newton(const ConeProblem& problem, Iterate& x, double tolerance);
    void solve_by_cautious_newton(const ConeProblem& problem, Iterate& x, double tolerance,
                                  double last_tolerance);
    void solve_from_interior_point(const ConeProblem& problem, Iterate& x, double tolerance);
    void solve_by_fixed_point(const ConeProblem& problem, Iterate& x, double tolerance);
    void solve_relaxed(const ConeProblem& problem, const Iterate& x);
    void keep_better(const ConeProblem& problem, Iterate& x);

    BodyMatrix joints, matrix;
    ConeAdmm admm;
    ConeInteriorPoint interior_point;
    ConeNewton newton;
    Iterate other;
    Eigen::VectorXd b;
    long count = 0;
};

}  // namespace hilda::lie
