// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_admm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::lie {

namespace {

constexpr double first_rho = 0.1;
constexpr int adapted_every = 20, most_adaptions = 5;  // of the penalty
constexpr int patience = 8;                  // iterations in which the residual must become half as large
constexpr double iterations_per_digit = 50;  // after which the tolerance has become ten times as large
constexpr double balanced = 10;              // ratio of the residuals

}  // namespace

int ConeAdmm::solve(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x, const Tolerances& to,
                    int most, bool accelerates)
{
    rho = first_rho;
    p = x.p;
    now = x;
    w.resize(p.size());
    for (int c = 0; c < problem.contacts(); ++c) {
        p[c] = project_on_cone(p[c], problem.mu[c]);
        const Vec3 u_hat = problem.u_hat(c, x.y);
        now.offset[c] = problem.beta[c] + problem.slip_term(c, u_hat);
        w[c] = u_hat + problem.g[c] * project_on_cone(-u_hat / problem.g[c], problem.mu[c]);  // on K*
    }
    factor(problem, matrix);
    const auto n = static_cast<Eigen::Index>(p.size());
    if (4 * n > memory.rows()) memory.resize(4 * n, 3);
    Eigen::Ref<Eigen::VectorXd> z = memory.col(0).head(4 * n), e = memory.col(1).head(4 * n),
                                plain = memory.col(2).head(4 * n);
    acceleration.resize(4 * n, 4 * n);
    int adaptions = 0, halved_at = 0;
    double halved = x.residual, last_change = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= most; ++k) {
        set_variables(problem, z);
        set_right_side(problem);
        matrix.solve(b, now.y);
        project(problem);
        if (now.residual < 0.5 * halved) halved = now.residual, halved_at = k;
        if (now.residual < x.residual) x = now;
        const double tolerance = std::min(to.last, to.first * std::pow(10, k / iterations_per_digit));
        if (x.residual <= to.least || (x.residual <= tolerance && k - halved_at >= patience)) return k;
        if (k % adapted_every == 0 && adaptions < most_adaptions && adapt_penalty()) {
            ++adaptions;
            factor(problem, matrix);
            acceleration.start();
            last_change = std::numeric_limits<double>::infinity();
            continue;
        }
        set_variables(problem, e);  // of the iteration without acceleration
        e -= z;
        const double change = e.norm();
        if (accelerates && change > last_change) {
            acceleration.start();
            last_change = std::numeric_limits<double>::infinity();
            take_variables(problem, plain);
            continue;
        }
        last_change = change;
        plain = z + e;
        if (accelerates) acceleration.accelerate(z, e);
        z += e;
        take_variables(problem, z);
    }
    return most;
}

/// (R_c p_c - w_c, s_c), the variables of the fixed point, all velocities
void ConeAdmm::set_variables(const ConeProblem& problem, Eigen::Ref<Eigen::VectorXd> out) const
{
    const auto n = static_cast<Eigen::Index>(p.size());
    for (Eigen::Index c = 0; c < n; ++c) {
        out.segment<3>(3 * c) = rho * problem.g[c] * p[c] - w[c];
        out[3 * n + c] = now.offset[c];
    }
}

void ConeAdmm::take_variables(const ConeProblem& problem, const Eigen::Ref<const Eigen::VectorXd>& from)
{
    const auto n = static_cast<Eigen::Index>(p.size());
    for (Eigen::Index c = 0; c < n; ++c) {
        const double R = rho * problem.g[c];
        const Vec3 a = from.segment<3>(3 * c) / R;
        p[c] = project_on_cone(a, problem.mu[c]);
        w[c] = R * (p[c] - a);
        now.offset[c] = from[3 * n + c];
    }
}

void ConeAdmm::factor(const ConeProblem& problem, BodyMatrix& matrix)
{
    W.resize(p.size());
    for (int c = 0; c < problem.contacts(); ++c) {
        const double by_R = 1 / (rho * problem.g[c]), tangential = problem.mu[c] > 0 ? by_R : 0;
        W[c] = Vec3(by_R, tangential, tangential).asDiagonal();
    }
    matrix.factor(problem, W);
}

void ConeAdmm::set_right_side(const ConeProblem& problem)
{
    b.resize(problem.unknowns());
    b.head(problem.q.size()) = problem.q;
    b.tail(problem.nu.size()) = problem.nu;
    for (int c = 0; c < problem.contacts(); ++c)
        problem.add_impulse(c, p[c] + W[c] * (w[c] - now.offset[c] * Vec3::UnitX()), b);
}

void ConeAdmm::project(const ConeProblem& problem)
{
    primal = dual = 0;
    now.residual = problem.joint_residual(now.y);
    for (int c = 0; c < problem.contacts(); ++c) {
        const double R = rho * problem.g[c];
        Vec3 u = problem.u(c, now.y);
        if (problem.mu[c] == 0) u.tail<2>().setZero();
        // the impulse with which now.y satisfies the momentum balance
        now.p[c] = p[c] + W[c] * (w[c] - u - now.offset[c] * Vec3::UnitX());
        now.offset[c] = problem.beta[c] + problem.slip_term(c, u);
        const Vec3 u_hat = u + now.offset[c] * Vec3::UnitX();
        const double error = problem.natural_map(c, now.p[c], u_hat);
        if (!(error <= now.residual)) now.residual = error;  // also NaN
        const Vec3 next = project_on_cone(p[c] - u_hat / R, problem.mu[c]);
        const Vec3 target = u_hat + R * (next - p[c]);
        primal = std::max(primal, (target - w[c]).norm() / rho);
        dual = std::max(dual, R * (next - p[c]).norm());
        p[c] = next;
        w[c] = target;
    }
}

bool ConeAdmm::adapt_penalty()
{
    const double ratio = primal / std::max(dual, 1e-300);
    if (ratio <= balanced && ratio * balanced >= 1) return false;
    constexpr double most_change = 10, least = 1e-8, largest = 1e4;
    rho = std::clamp(rho * std::clamp(std::sqrt(ratio), 1 / most_change, most_change), least, largest);
    return true;
}

}  // namespace hilda::lie
