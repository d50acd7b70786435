// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/coupled_bounds.hpp"

#include "lie/solver/saddle.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

namespace {

constexpr int max_iterations = 100;
constexpr double residual_tolerance = 1e-11;  // of min(q, s)
constexpr double accepted = 1e-3;             // if the tolerance is not reached
constexpr double largest_step = 3;            // of q = ln p in one iteration of Newton's method
constexpr int max_halvings = 4;

double normal_force(const BoundedPair& c, const Eigen::Ref<const Eigen::VectorXd>& lambda)
{
    return c.n.dot(lambda.segment<3>(c.normal_row));
}

}  // namespace

void CoupledBounds::set_responses(Saddle& K)
{
    const auto a = static_cast<Eigen::Index>(active.size());
    S.resize(2 * a, 2 * a), Q.resize(a, 2 * a);
    b.resize(K.size());
    for (Eigen::Index column = 0; column < 2 * a; ++column) {
        b.setZero();
        K.constraint_part(b)[active[static_cast<size_t>(column / 2)].pair->first + column % 2] = 1;
        K.solve_constraints(b);
        const auto response = K.constraint_part(b);
        for (Eigen::Index k = 0; k < a; ++k) {
            const BoundedPair& c = *active[static_cast<size_t>(k)].pair;
            S.block<2, 1>(2 * k, column) = response.segment<2>(c.first);
            Q(k, column) = normal_force(c, response);
        }
    }
}

/// λ, N, the bounds, s and the residual min(q, s) for the present q
void CoupledBounds::evaluate()
{
    const Eigen::Index a = q.size();
    for (Eigen::Index k = 0; k < a; ++k) {
        const Active& at = active[static_cast<size_t>(k)];
        delta[2 * k] = delta[2 * k + 1] = at.mobility * (std::exp(q[k]) - at.p);
    }
    matrix.noalias() = -S * delta.asDiagonal();
    matrix.diagonal().array() += 1;
    regularised.compute(matrix);
    lambda.noalias() = regularised.solve(lambda_0);
    change = delta.cwiseProduct(lambda);
    N = N_0;
    N.noalias() += Q * change;
    for (Eigen::Index k = 0; k < a; ++k) {
        const Active& at = active[static_cast<size_t>(k)];
        const double length = lambda.segment<2>(2 * k).norm();
        bound[k] = std::max({at.pair->mu * N[k], at.floor, length * std::exp(q[k]) / largest_scale});
        s[k] = std::log(bound[k] / length);
        residual[k] = std::min(q[k], s[k]);
    }
}

/// A damped step of Newton's method for min(q, s) = 0. Returns false, with q unchanged, if it does not reduce
/// the residual.
bool CoupledBounds::newton_step()
{
    const Eigen::Index a = q.size();
    J.setZero(a, a);
    by_q.resize(2 * a, a), lambda_by_q.resize(2 * a, a);
    for (Eigen::Index k = 0; k < a; ++k)
        by_q.col(k) = active[static_cast<size_t>(k)].mobility * std::exp(q[k]) *
                      (S.middleCols<2>(2 * k) * lambda.segment<2>(2 * k));
    lambda_by_q.noalias() = regularised.solve(by_q);
    for (Eigen::Index k = 0; k < a; ++k) {
        const Active& at = active[static_cast<size_t>(k)];
        if (q[k] < s[k]) {
            J(k, k) = 1;
            continue;
        }
        const auto of_pair = lambda.segment<2>(2 * k);
        for (Eigen::Index l = 0; l < a; ++l)
            J(k, l) = -of_pair.dot(lambda_by_q.col(l).segment<2>(2 * k)) / of_pair.squaredNorm();
        if (at.pair->mu * N[k] == bound[k]) {
            for (Eigen::Index l = 0; l < a; ++l) {
                const Active& by = active[static_cast<size_t>(l)];
                double dN =
                    by.mobility * std::exp(q[l]) * Q.row(k).segment<2>(2 * l).dot(lambda.segment<2>(2 * l));
                for (Eigen::Index c = 0; c < 2 * a; ++c) dN += Q(k, c) * delta[c] * lambda_by_q(c, l);
                J(k, l) += dN / N[k];
            }
        }
    }
    newton.compute(J);
    step.noalias() = newton.solve(residual);
    step *= -1;
    if (!step.allFinite()) return false;
    if (const double most = step.cwiseAbs().maxCoeff(); most > largest_step) step *= largest_step / most;
    q_before = q;
    const double before = residual.norm();
    for (int half = 0; half <= max_halvings; ++half, step *= 0.5) {
        q = (q_before + step).cwiseMax(0);
        evaluate();
        if (residual.norm() < before) return true;
    }
    q = q_before;
    evaluate();
    return false;
}

bool CoupledBounds::solve(Saddle& K, Eigen::VectorXd& z, const std::vector<BoundedPair>& pair, double h,
                          const std::vector<double>& floor, std::vector<double>& p)
{
    active.clear();
    for (size_t n = 0; n < pair.size(); ++n)
        if (pair[n].K != 0) active.push_back({&pair[n], n, pair[n].mobility(h) / h, p[n], floor[n]});
    const auto a = static_cast<Eigen::Index>(active.size());
    set_responses(K);
    const auto at_entry = K.constraint_part(z);
    for (Eigen::VectorXd* v : {&lambda_0, &lambda, &delta, &change}) v->resize(2 * a);
    for (Eigen::VectorXd* v : {&N_0, &N, &q, &s, &bound, &residual, &step}) v->resize(a);
    matrix.resize(2 * a, 2 * a);
    for (Eigen::Index k = 0; k < a; ++k) {
        const Active& c = active[static_cast<size_t>(k)];
        lambda_0.segment<2>(2 * k) = at_entry.segment<2>(c.pair->first);
        N_0[k] = normal_force(*c.pair, at_entry);
        q[k] = std::log(c.p);
    }
    evaluate();
    for (int k = 0; k < max_iterations && residual.allFinite() && !(largest_residual() < residual_tolerance);
         ++k) {
        if (newton_step()) continue;
        q = (q - s).cwiseMax(0);
        evaluate();
    }
    // The rounding errors of S grow with the distance from p on entry. The caller repeats the search from
    // there.
    if (!(largest_residual() < accepted)) return false;
    for (Eigen::Index k = 0; k < a; ++k) p[active[static_cast<size_t>(k)].number] = std::exp(q[k]);
    return true;
}

double CoupledBounds::normal_response(Saddle& K, const BoundedPair& pair, const Eigen::Vector2d& t)
{
    b.resize(K.size());
    Eigen::Matrix2d by_row;
    Eigen::RowVector2d normal;
    for (int d = 0; d < 2; ++d) {
        b.setZero();
        K.constraint_part(b)[pair.first + d] = 1;
        K.solve_constraints(b);
        by_row.col(d) = K.constraint_part(b).segment<2>(pair.first);
        normal[d] = normal_force(pair, K.constraint_part(b));
    }
    return normal * by_row.inverse() * t;
}

}  // namespace hilda::lie
