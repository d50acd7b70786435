// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/implicit_springs.hpp"

#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

namespace {

/// Zero for a negative number or NaN
double positive(double x) { return x > 0 ? x : 0; }

/// 1/(1 - exp(-x)) - 1/x, x ≥ 0
double exponential_weight(double x)
{
    return x < 1e-2 ? 0.5 + x / 12 - x * x * x / 720 : -1 / std::expm1(-x) - 1 / x;
}

}  // namespace

/// The saddle matrix without springs. The condensed solver has no pivots that depend on the first state, so
/// that a resumed run gives the same digits.
struct ImplicitSprings::AtNode {
    AtNode(const System& system, const Springs& springs)
        : K(system, Metric::mass, LinearSolver::condensed), springs(springs), v(K.size()), b(K.size()),
          gamma(springs.gamma)
    {}
    Saddle K;
    Springs springs;
    Eigen::VectorXd v, b;
    std::vector<double> gamma;
};

ImplicitSprings::ImplicitSprings(const System& system, Rule rule)
    : system(system), rule(rule), springs(rule == Rule::none ? Springs() : system.spring_pattern()),
      compliances(springs.stiffness.size()), theta(compliances.size(), 1)
{
    if (empty()) return;
    for (const Mat3& J_bar : system.mass().J_bar) J_bar_inverse.emplace_back(J_bar.inverse());
    if (rule == Rule::midpoint) at_node = std::make_unique<AtNode>(system, springs);
}

ImplicitSprings::ImplicitSprings(ImplicitSprings&&) noexcept = default;
ImplicitSprings::~ImplicitSprings() = default;

void ImplicitSprings::start(const State& x, double step)
{
    if (empty()) return;
    h = step;
    system.update_springs(x, springs);
    Rows& C = springs.rows;
    const Mass& mass = system.mass();
    for (size_t n = 0; n < compliances.size(); ++n) {
        double &k = springs.stiffness[n], &c = springs.damping[n], W = 0;
        k = positive(k), c = positive(c);
        const int first = C.start[n], last = C.start[n + 1];
        for (int e = first; e < last; ++e) {
            const Rows::Entry& at = C.entry[e];
            W += at.r.squaredNorm() / mass.m[at.body] + at.pi.dot(J_bar_inverse[at.body] * at.pi);
        }
        if (rule == Rule::midpoint) theta[n] = exponential_weight(h * c * W);
        const double d = rule == Rule::euler ? h * k + c : h * k / 4 + c * theta[n];
        if (d > 0 && W > 0) {
            compliances[n] = 1 / (h * d);
            continue;
        }
        compliances[n] = 1;  // a row without load: its multiplier is zero
        C.clear(static_cast<int>(n));
    }
}

double ImplicitSprings::by_gamma(size_t n) const
{
    const double k = springs.stiffness[n], c = springs.damping[n];
    return rule == Rule::euler ? h * (h / 2 * k + c) : h * (h / 4 * k + (theta[n] - 0.5) * c);
}

void ImplicitSprings::smooth_start(State& x) const
{
    Saddle K(system, Metric::mass, LinearSolver::klu, springs.rows);
    const int rows = springs.rows.rows();
    Eigen::VectorXd v(K.size()), b(K.size());
    const auto solve = [&](const Rows& C, const std::vector<double>& compliance, auto first, auto second) {
        K.set_springs(C, compliance);
        K.assemble(x);
        v.setZero();
        for (size_t i = 0; i < x.body.size(); ++i)
            v.segment<6>(static_cast<Eigen::Index>(6 * i)) << x.body[i].*first, x.body[i].*second;
        K.multiply(v, b);
        K.constraint_part(b).tail(rows).setZero();
    };
    const auto take = [&](auto first, auto second) {
        K.solve(b);
        for (size_t i = 0; i < x.body.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(6 * i);
            x.body[i].*first = b.segment<3>(at);
            x.body[i].*second = b.segment<3>(at + 3);
        }
    };
    solve(springs.rows, compliances, &Motion::rddot, &Motion::omegadot_bar);
    for (int n = 0; n < rows; ++n) {
        const auto at = static_cast<size_t>(n);
        K.constraint_part(b).tail(rows)[n] = -compliances[at] * by_gamma(at) * springs.gamma[at];
    }
    take(&Motion::rddot, &Motion::omegadot_bar);

    Rows with_stiffness = springs.rows;
    std::vector<double> of_stiffness(compliances.size(), 1);
    for (int n = 0; n < rows; ++n)
        if (const double k = springs.stiffness[static_cast<size_t>(n)]; h * h * k > 0)
            of_stiffness[static_cast<size_t>(n)] = 4 / (h * h * k);
        else
            with_stiffness.clear(n);
    solve(with_stiffness, of_stiffness, &Motion::rdot, &Motion::omega_bar);
    take(&Motion::rdot, &Motion::omega_bar);
}

void ImplicitSprings::restore_velocities(State& node, const Eigen::VectorXd& history, double step) const
{
    Saddle& K = at_node->K;
    Springs& at = at_node->springs;
    Eigen::VectorXd &v = at_node->v, &b = at_node->b;
    std::vector<double>& gamma = at_node->gamma;
    const int bodies = static_cast<int>(node.body.size());
    v.setZero();
    for (int i = 0; i < bodies; ++i) v.segment<6>(6 * i) << node.body[i].rdot, node.body[i].omega_bar;
    const auto evaluate = [&](const Eigen::VectorXd& velocities, int first) {
        for (int i = 0; i < bodies; ++i) {
            node.body[i].rdot = velocities.segment<3>(first + 6 * i);
            node.body[i].omega_bar = velocities.segment<3>(first + 6 * i + 3);
        }
        system.update_springs(node, at);
    };
    evaluate(history, 0);
    gamma = at.gamma;
    evaluate(history, 6 * bodies);
    for (size_t n = 0; n < gamma.size(); ++n) gamma[n] -= at.gamma[n];
    evaluate(v, 0);
    K.assemble(node);
    K.multiply(v, b);
    const Rows& C = at.rows;
    for (int n = 0; n < C.rows(); ++n) {
        const auto number = static_cast<size_t>(n);
        const double impulse =
            step * step / 4 * positive(at.stiffness[number]) * (C.dot(n, v) + step / 4 * gamma[number]);
        for (int e = C.start[n]; e < C.start[n + 1]; ++e) {
            b.segment<3>(6 * C.entry[e].body) += impulse * C.entry[e].r;
            b.segment<3>(6 * C.entry[e].body + 3) += impulse * C.entry[e].pi;
        }
    }
    K.solve(b);
    for (int i = 0; i < bodies; ++i) {
        node.body[i].rdot = b.segment<3>(6 * i);
        node.body[i].omega_bar = b.segment<3>(6 * i + 3);
    }
}

void ImplicitSprings::set_right_side(const Eigen::VectorXd& before, const Eigen::VectorXd& node,
                                     Eigen::Ref<Eigen::VectorXd> out) const
{
    for (int n = 0; n < static_cast<int>(compliances.size()); ++n) {
        const auto at = static_cast<size_t>(n);
        const double k = springs.stiffness[at], c = springs.damping[at];
        const double of_before = rule == Rule::euler ? 0 : (1 - theta[at]) * c - h * k / 4;
        const double h_lambda_0 = of_before * springs.rows.dot(n, before) - c * springs.rows.dot(n, node) +
                                  h * by_gamma(at) * springs.gamma[at];
        out[n] = -h * compliances[at] * h_lambda_0;
    }
}

}  // namespace hilda::lie
