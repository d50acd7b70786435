// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/implicit_springs.hpp"

#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

namespace {

constexpr double no_load = 1e30;  // compliance of a row without stiffness [1/kg]

/// 1/(1 - exp(-x)) - 1/x, x ≥ 0
double exponential_weight(double x)
{
    return x < 1e-2 ? 0.5 + x / 12 - x * x * x / 720 : -1 / std::expm1(-x) - 1 / x;
}

}  // namespace

/// The saddle matrix without springs. The condensed solver has no pivots that depend on the first state, so that
/// a resumed run gives the same digits.
struct ImplicitSprings::AtNode {
    AtNode(const System& system, const Springs& springs)
        : K(system, Metric::mass, LinearSolver::condensed), springs(springs), v(K.size()), b(K.size())
    {}
    Saddle K;
    Springs springs;
    Eigen::VectorXd v, b;
};

ImplicitSprings::ImplicitSprings(const System& system, Rule rule)
    : system(system), rule(rule), springs(rule == Rule::none ? Springs() : system.spring_pattern()),
      compliances(springs.stiffness.size()), theta(compliances.size(), 1)
{
    if (rule == Rule::midpoint && !empty()) at_node = std::make_unique<AtNode>(system, springs);
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
        k = std::max(k, 0.), c = std::max(c, 0.);
        const int first = C.start[n], last = C.start[n + 1];
        for (int e = first; e < last; ++e) {
            const Rows::Entry& at = C.entry[e];
            W += at.r.squaredNorm() / mass.m[at.body] + at.pi.dot(mass.J_bar[at.body].inverse() * at.pi);
        }
        if (rule == Rule::midpoint) theta[n] = exponential_weight(h * c * W);
        const double d = rule == Rule::euler ? h * k + c : h * k / 4 + c * theta[n];
        if (d > 0 && W > 0) {
            compliances[n] = 1 / (h * d);
            continue;
        }
        compliances[n] = 1;  // a row without load: its multiplier is zero
        for (int e = first; e < last; ++e) C.entry[e].r.setZero(), C.entry[e].pi.setZero();
    }
}

void ImplicitSprings::smooth_start(State& x) const
{
    Saddle K(system, Metric::mass, LinearSolver::klu, springs.rows);
    Eigen::VectorXd v(K.size()), b(K.size());
    std::vector<double> of_stiffness(compliances.size());
    for (size_t n = 0; n < compliances.size(); ++n)
        of_stiffness[n] = std::min(4 / (h * h * springs.stiffness[n]), no_load);
    const auto solve = [&](const std::vector<double>& compliance, auto first, auto second) {
        K.set_springs(springs.rows, compliance);
        K.assemble(x);
        v.setZero();
        for (size_t i = 0; i < x.body.size(); ++i)
            v.segment<6>(static_cast<Eigen::Index>(6 * i)) << x.body[i].*first, x.body[i].*second;
        K.multiply(v, b);
        K.constraint_part(b).tail(springs.rows.rows()).setZero();
        K.solve(b);
        for (size_t i = 0; i < x.body.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(6 * i);
            x.body[i].*first = b.segment<3>(at);
            x.body[i].*second = b.segment<3>(at + 3);
        }
    };
    solve(compliances, &Motion::rddot, &Motion::omegadot_bar);
    solve(of_stiffness, &Motion::rdot, &Motion::omega_bar);
}

void ImplicitSprings::restore_velocities(State& node, double step) const
{
    auto& [K, at, v, b] = *at_node;
    system.update_springs(node, at);
    K.assemble(node);
    v.setZero();
    for (size_t i = 0; i < node.body.size(); ++i)
        v.segment<6>(static_cast<Eigen::Index>(6 * i)) << node.body[i].rdot, node.body[i].omega_bar;
    K.multiply(v, b);
    const Rows& C = at.rows;
    for (int n = 0; n < C.rows(); ++n) {
        const double impulse =
            0.25 * step * step * std::max(at.stiffness[static_cast<size_t>(n)], 0.) * C.dot(n, v);
        for (int e = C.start[n]; e < C.start[n + 1]; ++e) {
            b.segment<3>(6 * C.entry[e].body) += impulse * C.entry[e].r;
            b.segment<3>(6 * C.entry[e].body + 3) += impulse * C.entry[e].pi;
        }
    }
    K.solve(b);
    for (size_t i = 0; i < node.body.size(); ++i) {
        node.body[i].rdot = b.segment<3>(static_cast<Eigen::Index>(6 * i));
        node.body[i].omega_bar = b.segment<3>(static_cast<Eigen::Index>(6 * i + 3));
    }
}

void ImplicitSprings::set_right_side(const Eigen::VectorXd& before, const Eigen::VectorXd& node,
                                     Eigen::Ref<Eigen::VectorXd> out) const
{
    for (int n = 0; n < static_cast<int>(compliances.size()); ++n) {
        const auto at = static_cast<size_t>(n);
        const double k = springs.stiffness[at], c = springs.damping[at];
        const double of_before = rule == Rule::euler ? 0 : (1 - theta[at]) * c - h * k / 4;
        const double lambda_0 = of_before * springs.rows.dot(n, before) - c * springs.rows.dot(n, node);
        out[n] = -h * compliances[at] * lambda_0;  // before and node contain the factor h
    }
}

}  // namespace hilda::lie
