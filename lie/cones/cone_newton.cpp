// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::lie {

namespace {

constexpr int before_growth = 50;                // factorisations with the first tolerance
constexpr double factorizations_per_digit = 50;  // after which the tolerance has become ten times as large
constexpr double largest_rho = 10, reduction_after_failure = 0.7;

}  // namespace

int ConeNewton::solve(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x, double tolerance,
                      const Options& options)
{
    rho = options.rho;
    coulomb = options.coulomb;
    const double least_rho = options.least * rho;
    W.resize(x.p.size());
    p = x.p;
    best.residual = std::numeric_limits<double>::infinity();
    int factored = 0;
    double reduction = options.reduction;
    for (int outer = 0; outer < options.most_outer && factored < options.most_factorizations; ++outer) {
        centre = x.p;
        offset = x.offset;
        before = x.y;
        set_impulses(problem, x.y);
        bool solved = false;
        for (int inner = 0; inner < options.most_inner && !solved; ++inner) {
            for (int c = 0; c < problem.contacts(); ++c) W[c] = weight(problem, c, x.y);
            set_residual(problem, x.y);
            matrix.factor(problem, W);
            ++factored;
            matrix.solve(e, step);
            x.y += line_search(problem, x.y) * step;
            set_impulses(problem, x.y);
            set_residual(problem, x.y);
            double change = 0;
            for (int c = 0; c < problem.contacts(); ++c)
                change = std::max(change, rho * problem.g[c] * (p[c] - centre[c]).norm());
            const double error = unbalance(problem);
            solved = error < 0.1 * change || error < 0.1 * tolerance;
        }
        if (!solved && options.growth > 1) {
            x.y = before;
            rho *= options.growth;
            reduction = std::max(reduction, reduction_after_failure);
            if (rho > largest_rho) break;
            continue;
        }
        x.p = p;
        x.residual = std::max(coulomb ? problem.residual(x) : problem.convex_residual(x), unbalance(problem));
        if (x.residual < best.residual) best = x;
        const double grown =
            tolerance * std::pow(10, std::max(0, factored - before_growth) / factorizations_per_digit);
        if (x.residual <= std::max(tolerance, std::min(options.last_tolerance, grown))) break;
        rho = std::max(reduction * rho, least_rho);
    }
    if (best.residual < x.residual) x = best;
    return factored;
}

/// û of the law, or u + offset n
Vec3 ConeNewton::u_hat(const ConeProblem& problem, int c, const Eigen::VectorXd& y) const
{
    if (coulomb) return problem.u_hat(c, y);
    return problem.u(c, y) + offset[c] * Vec3::UnitX();
}

/// -∂p_c/∂u_c
Mat3 ConeNewton::weight(const ConeProblem& problem, int c, const Eigen::VectorXd& y) const
{
    const double R = rho * problem.g[c];
    const Vec3 w = u_hat(problem, c, y);
    Mat3 derivative = cone_projection_derivative(centre[c] - w / R, problem.mu[c]) / R;
    const double slip = tangential(w);
    if (!coulomb || slip == 0) return derivative;
    Mat3 of_u_hat = Mat3::Identity();
    of_u_hat.row(0).tail<2>() = problem.mu[c] / slip * w.tail<2>().transpose();
    return derivative * of_u_hat;
}

/// The fraction of `step` that reduces the function which the convex problem minimises (Armijo's rule), or
/// the residual of the momenta. e is the residual at y.
double ConeNewton::line_search(const ConeProblem& problem, Eigen::VectorXd& y)
{
    const Eigen::Index n = problem.q.size();
    constexpr double least = 1e-6, share = 1e-4;
    double slope = 0, before = 0;
    if (coulomb) {
        before = length_of_residual(problem);
    } else {
        trial = e;  // without the multipliers it is minus the gradient
        problem.C_b->add_transpose(1, y.tail(problem.C_b->rows()), trial);
        slope = -trial.head(n).dot(step.head(n));
        before = value(problem, y);
    }
    double fraction = 1;
    for (; fraction > least; fraction *= 0.5) {
        trial = y + fraction * step;
        if (coulomb) {
            set_impulses(problem, trial);
            set_residual(problem, trial);
            if (length_of_residual(problem) <= (1 - share * fraction) * before) break;
            if (fraction < 0.1) break;  // a local minimum: the next outer iteration has another residual
        } else if (value(problem, trial) <= before + share * fraction * slope + 1e-14 * std::abs(before)) {
            break;
        }
    }
    return fraction;
}

void ConeNewton::set_impulses(const ConeProblem& problem, const Eigen::VectorXd& y)
{
    for (int c = 0; c < problem.contacts(); ++c) {
        const double R = rho * problem.g[c];
        p[c] = project_on_cone(centre[c] - u_hat(problem, c, y) / R, problem.mu[c]);
    }
}

/// e = (q + Σ C_cᵀ p_c - M v - C_bᵀ λ, ν - C_b v)
void ConeNewton::set_residual(const ConeProblem& problem, const Eigen::VectorXd& y)
{
    const Rows& C = *problem.C_b;
    e.resize(y.size());
    problem.set_right_side(p, e);
    for (int b = 0; b < problem.bodies(); ++b)
        e.segment<6>(6 * b) -= problem.times_mass(b, y.segment<6>(6 * b));
    C.add_transpose(-1, y.tail(C.rows()), e);
    for (int k = 0; k < C.rows(); ++k) e[problem.q.size() + k] -= C.dot(k, y);
}

/// ½ vᵀ M v - qᵀ v + Σ ½ R_c |p_c(v)|²
double ConeNewton::value(const ConeProblem& problem, const Eigen::VectorXd& y) const
{
    double sum = 0;
    for (int b = 0; b < problem.bodies(); ++b) {
        const ConeProblem::Vec6 v = y.segment<6>(6 * b);
        sum += v.dot(0.5 * problem.times_mass(b, v) - problem.q.segment<6>(6 * b));
    }
    for (int c = 0; c < problem.contacts(); ++c) {
        const double R = rho * problem.g[c];
        const Vec3 u = problem.u(c, y) + offset[c] * Vec3::UnitX();
        sum += 0.5 * R * project_on_cone(centre[c] - u / R, problem.mu[c]).squaredNorm();
    }
    return sum;
}

/// √(eᵀ M⁻¹ e) of the momenta
double ConeNewton::length_of_residual(const ConeProblem& problem) const
{
    double sum = 0;
    for (int b = 0; b < problem.bodies(); ++b) {
        const ConeProblem::Vec6 of = e.segment<6>(6 * b);
        sum += of.dot(problem.by_mass(b, of));
    }
    return std::sqrt(sum);
}

/// Largest velocity at a contact point that the residual of the momenta would cause
double ConeNewton::unbalance(const ConeProblem& problem) const
{
    double largest = 0;
    for (int c = 0; c < problem.contacts(); ++c) {
        const ConeRows::Cone& cone = (*problem.cones)[c];
        Vec3 u = Vec3::Zero();
        if (cone.i >= 0) u += cone.C_i * problem.by_mass(cone.i, e.segment<6>(6 * cone.i));
        if (cone.j >= 0) u += cone.C_j * problem.by_mass(cone.j, e.segment<6>(6 * cone.j));
        const double error = u.cwiseAbs().maxCoeff();
        if (!(error <= largest)) largest = error;
    }
    return std::max(largest, e.tail(problem.nu.size()).lpNorm<Eigen::Infinity>());
}

}  // namespace hilda::lie
