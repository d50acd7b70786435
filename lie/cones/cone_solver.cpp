// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_solver.hpp"

#include "lie/check.hpp"
#include "lie/steps/anderson.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::lie {

namespace {

constexpr int most_admm = 300, most_cautious_newton = 400, most_patient_admm = 3000, most_newton = 50,
              most_passes = 20;
// in units of rounding()
constexpr double least_rounding = 4, most_rounding = 64;
// parts of the acceptable residual: the aim of all methods, the residual below which only the quick ones are
// tried, and the last tolerance of the cautious Newton method
constexpr double good = 5e-3, sufficient = 0.1, last = 0.9;

/// Rounding error of the residual: that of the velocities which the impulses cause
double rounding(const ConeProblem& problem, const ConeProblem::Iterate& x)
{
    double largest = 0;
    for (int c = 0; c < problem.contacts(); ++c) largest = std::max(largest, problem.g[c] * x.p[c].norm());
    return std::numeric_limits<double>::epsilon() * largest;
}

}  // namespace

ConeSolver::ConeSolver(const Mass& mass, const Rows& pattern) : joints(mass, pattern), matrix(mass, pattern)
{}

void ConeSolver::start(ConeProblem& problem)
{
    problem.set_scales();
    if (problem.C_b->rows() > 0) joints.factor_joints(problem);
}

void ConeSolver::set_velocities(const ConeProblem& problem, Iterate& x)
{
    b.resize(problem.unknowns());
    x.y.resize(problem.unknowns());
    problem.set_right_side(x.p, b);
    if (problem.C_b->rows() > 0) {
        joints.solve(b, x.y);
        return;
    }
    for (int i = 0; i < problem.bodies(); ++i)
        x.y.segment<6>(6 * i) = problem.by_mass(i, b.segment<6>(6 * i));
}

ConeSolver::Outcome ConeSolver::solve(const ConeProblem& problem, Iterate& x, const Tolerances& to)
{
    x.offset.resize(x.p.size());
    set_velocities(problem, x);
    x.residual = problem.residual(x);
    const auto at_least = [&](double tolerance) {
        return std::min(std::max(tolerance, most_rounding * rounding(problem, x)), to.acceptable);
    };
    if (x.residual <= at_least(to.start)) return {.residual = x.residual};

    other.residual = std::numeric_limits<double>::infinity();
    matrix.set_contacts(problem);
    const double aim = std::max(at_least(to.result), good * to.acceptable),
                 enough = std::max(aim, sufficient * to.acceptable),
                 fair = std::max(enough, last * to.acceptable);
    count +=
        admm.solve(problem, matrix, x, {to.result, aim, least_rounding * rounding(problem, x)}, most_admm);
    if (!(x.residual <= aim)) {
        try {
            solve_by_newton(problem, x, aim);
            if (!(x.residual <= enough)) solve_by_cautious_newton(problem, x, aim, fair);
            // An accelerated iteration can cycle where the plain one converges slowly.
            for (const bool accelerates : {false, true}) {
                if (x.residual <= fair) break;
                count += admm.solve(problem, matrix, x, {aim, aim, aim}, most_patient_admm, accelerates);
                if (!(x.residual <= fair)) solve_by_cautious_newton(problem, x, aim, fair);
            }
            if (!(x.residual <= fair)) solve_from_interior_point(problem, x, aim);
            if (!(x.residual <= fair)) solve_by_fixed_point(problem, x, aim);
        } catch (const NumericalFailure&) {
            // a matrix that is not finite; the best iterate remains
        }
    }
    Outcome outcome{.residual = x.residual};
    if (x.residual <= to.acceptable) return outcome;
    outcome.worst = problem.worst_contact(x);
    if (!(other.residual <= to.acceptable)) solve_relaxed(problem, x);
    if (other.residual <= to.acceptable && problem.convex_residual(other) <= to.acceptable) {
        x = other;
        outcome.residual = problem.residual(x);
        outcome.worst = problem.worst_contact(x);
        outcome.status = Status::friction_relaxed;
    } else {
        outcome.status = Status::failed;
    }
    return outcome;
}

/// Keeps `other`, a result of Newton's method or of the interior point, in x if its residual of the law and
/// of the momenta is smaller.
void ConeSolver::keep_better(const ConeProblem& problem, Iterate& x)
{
    const double residual = std::max(problem.residual(other), other.residual);
    if (!(residual < x.residual)) return;
    x = other;
    x.residual = residual;
}

/// From the result of ADMM, which has the active contacts mostly
void ConeSolver::solve_by_newton(const ConeProblem& problem, Iterate& x, double tolerance)
{
    other = x;
    count += newton.solve(problem, matrix, other, tolerance,
                          {.rho = 1e-3, .most_outer = 3, .most_inner = 4, .coulomb = true, .reduction = 0.1});
    keep_better(problem, x);
}

/// In piles, the impulses that bodies at rest exert on each other change slowly in ADMM, and Newton's method
/// with small proximal terms does not converge.
void ConeSolver::solve_by_cautious_newton(const ConeProblem& problem, Iterate& x, double tolerance,
                                          double last_tolerance)
{
    other = x;
    count += newton.solve(problem, matrix, other, tolerance,
                          {.rho = 1e-2,
                           .most_outer = most_cautious_newton,
                           .most_inner = 8,
                           .most_factorizations = most_cautious_newton,
                           .last_tolerance = last_tolerance,
                           .coulomb = true,
                           .reduction = 0.3,
                           .least = 1e-4,
                           .growth = 3});
    keep_better(problem, x);
}

void ConeSolver::solve_from_interior_point(const ConeProblem& problem, Iterate& x, double tolerance)
{
    other = x;
    for (int c = 0; c < problem.contacts(); ++c) other.offset[c] = problem.beta[c];
    count += interior_point.solve(problem, matrix, other, 1e-7);
    other.residual = std::numeric_limits<double>::infinity();
    count += newton.solve(
        problem, matrix, other, tolerance,
        {.rho = 1e-3, .most_outer = most_newton, .most_inner = 30, .coulomb = true, .reduction = 0.1});
    keep_better(problem, x);
}

/// Sets `other` to the solution of the convex problem with the slip terms of x.
void ConeSolver::solve_relaxed(const ConeProblem& problem, const Iterate& x)
{
    other = x;
    for (int c = 0; c < problem.contacts(); ++c)
        other.offset[c] = problem.beta[c] + problem.slip_term(c, problem.u(c, x.y));
    other.residual = std::numeric_limits<double>::infinity();
    try {
        count += interior_point.solve(problem, matrix, other, 1e-7);
    } catch (const NumericalFailure&) {
        // a matrix that is not finite; other.residual tells it
    }
}

/// Each pass solves the convex problem for the slip terms s. The next ones are those of Anderson's
/// acceleration of the iteration s ← μ |u_t|.
void ConeSolver::solve_by_fixed_point(const ConeProblem& problem, Iterate& x, double tolerance)
{
    const int n = problem.contacts();
    Eigen::VectorXd s(n), change(n);
    Anderson acceleration(n, n);
    other = x;
    for (int c = 0; c < n; ++c) s[c] = problem.slip_term(c, problem.u(c, x.y));
    for (int pass = 0; pass < most_passes; ++pass) {
        for (int c = 0; c < n; ++c) other.offset[c] = problem.beta[c] + s[c];
        count += interior_point.solve(problem, matrix, other, 1e-7);
        const Iterate of_interior_point = other;
        other.residual = std::numeric_limits<double>::infinity();
        count += newton.solve(problem, matrix, other, 0.1 * tolerance,
                              {.rho = 1e-4, .most_outer = 10, .most_inner = 20, .reduction = 0.3});
        if (!(other.residual <= of_interior_point.residual)) other = of_interior_point;
        keep_better(problem, x);
        if (x.residual <= tolerance) return;
        for (int c = 0; c < n; ++c) change[c] = problem.slip_term(c, problem.u(c, other.y)) - s[c];
        acceleration.accelerate(s, change);
        s = (s + change).cwiseMax(0);
    }
}

}  // namespace hilda::lie
