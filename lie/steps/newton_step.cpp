// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/newton_step.hpp"

#include "lie/check.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <sstream>

namespace hilda::lie {

NewtonStep::NewtonStep(const System& model, const Settings& settings)
    : model(model), mass(model.mass()), bodies(model.bodies()), settings(settings), loads(bodies)
{
    for (const Mat3& J_bar : mass.J_bar) J_bar_inverse.push_back(J_bar.inverse());
    set_rounding_mass();
}

NewtonStep::Attempt::~Attempt()
{
    if (!accepted) x = x_n;
}

Vec3 NewtonStep::tau_bar(int i, const Motion& body) const
{
    return loads.tau_bar(i, mass.J_bar[i], body.omega_bar);
}

void NewtonStep::predict(double by_v, double by_vdot, double by_lambda)
{
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x_n.body[i];
        z.segment<6>(6 * i) << by_v * body.rdot + by_vdot * body.rddot,
            by_v * body.omega_bar + by_vdot * body.omegadot_bar;
    }
    constraint_part(z) = by_lambda * x_n.lambda;
    algebraic_part(z).setZero();
}

void NewtonStep::place_increments(State& x) const
{
    for (int i = 0; i < bodies; ++i) {
        x.body[i].r = x_n.body[i].r + z.segment<3>(6 * i);
        x.body[i].A = x_n.body[i].A * exp(z.segment<3>(6 * i + 3));
    }
}

void NewtonStep::place_algebraic(State& x, double factor) const
{
    if (x_n.alpha.size() == 0) return;
    x.alpha = x_n.alpha;
    const Rows& C = model.pattern();
    move_algebraic(C, x, z.tail(C.algebraic_variables()), factor);
}

void NewtonStep::take_algebraic(const State& x, double factor)
{
    Eigen::Index at = z.size() - algebraic_part(z).size();
    for (const Rows::AlgebraicGroup& group : model.pattern().algebraic) {
        z.segment(at, group.count) = factor * (x.alpha.segment(group.first_alpha, group.count) -
                                               x_n.alpha.segment(group.first_alpha, group.count));
        at += group.count;
    }
}

void NewtonStep::set_motion_residual(const State& x, Rows& C)
{
    model.loads(x, loads);
    model.variation(x, C);
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x.body[i];
        e.segment<3>(6 * i) = mass.m[i] * body.rddot - loads.F[i];
        e.segment<3>(6 * i + 3) = mass.J_bar[i] * body.omegadot_bar - tau_bar(i, body);
    }
    C.add_transpose(1, x.lambda, e);
    algebraic_part(e).setZero();
    C.add_algebraic_transpose(1, x.lambda, algebraic_part(e));
}

double NewtonStep::length_of_motion(Eigen::VectorXd& e) const
{
    return std::sqrt(e.head(6 * bodies).squaredNorm() + algebraic_part(e).squaredNorm());
}

bool NewtonStep::converged(int k, double motion, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                           double factor)
{
    if (k == 1) {
        ulp = 0;
        for (const Motion& body : x_n.body) ulp = std::max(ulp, body.r.cwiseAbs().maxCoeff());
        ulp *= std::numeric_limits<double>::epsilon();
    }
    double sum = motion * motion;
    for (Eigen::Index row = 0; row < multipliers.size(); ++row) {
        const double change = factor * multipliers[row];
        if (!(std::abs(change) < ulp * rounding_mass[row])) sum += change * change;
    }
    const double before = correction;
    correction = std::sqrt(sum / std::max(1.0, bodies / 4.0));
    if (correction < std::max(settings.tolerance, 4 * ulp)) return true;
    return k > 2 && correction > 0.5 * before && correction < 1e3 * ulp;
}

void NewtonStep::take_loads(State& node, const State& after)
{
    node.lambda = after.lambda;
    for (size_t i = 0; i < node.body.size(); ++i) {
        node.body[i].rddot = after.body[i].rddot;
        node.body[i].omegadot_bar = after.body[i].omegadot_bar;
    }
}

void NewtonStep::refuse_whole_turns(const State& x, double h, const std::string& scheme) const
{
    for (int i = 0; i < bodies; ++i)
        if (const double angle = h * x.body[i].omega_bar.norm(); !(angle < std::numbers::pi)) {
            std::ostringstream what;
            what.precision(3);
            what << scheme << ": " << model.body_name(i) << " rotates by " << angle
                 << " rad in one step, and the limit is pi; reduce the step";
            throw NumericalFailure("step_too_large", what.str());
        }
}

int NewtonStep::done(Attempt& attempt, int k)
{
    attempt.accepted = true;
    ++steps;
    iterations += k;
    return k;
}

void NewtonStep::no_convergence(const std::string& scheme, double correction, const State& x) const
{
    std::ostringstream what;
    what.precision(2);
    what << scheme << ": correction " << correction << " after " << settings.max_iterations << " iterations";
    NoConvergence failure(what.str(), correction, settings.max_iterations);
    if (model.rows() > 0) {
        Eigen::VectorXd Phi(model.rows());
        model.phi(x, Phi);
        int largest = 0;
        failure.residual = Phi.cwiseAbs().maxCoeff(&largest);
        failure.largest = model.row_name(largest);
    }
    throw failure;
}

void NewtonStep::set_rounding_mass()
{
    const Rows& C = model.pattern();
    // Union-find: bodies that rows connect form a group, represented by one of them.
    std::vector<int> group(bodies);
    std::iota(group.begin(), group.end(), 0);
    const auto first = [&](int b) {
        while (group[b] != b) b = group[b] = group[group[b]];
        return b;
    };
    for (int k = 0; k < C.rows(); ++k)
        for (int n = C.start[k] + 1; n < C.start[k + 1]; ++n)
            group[first(C.entry[n].body)] = first(C.entry[n - 1].body);
    std::vector<double> group_mass(bodies);
    for (int b = 0; b < bodies; ++b) group_mass[first(b)] += mass.m[b];
    rounding_mass.setZero(C.rows());
    for (int k = 0; k < C.rows(); ++k)
        if (C.start[k] < C.start[k + 1]) rounding_mass[k] = 4 * group_mass[first(C.entry[C.start[k]].body)];
    // Rows of an algebraic group without a body have the value of the other rows.
    for (const Rows::AlgebraicGroup& algebraic : C.algebraic) {
        auto of_rows = rounding_mass.segment(algebraic.first, algebraic.rows);
        of_rows.setConstant(of_rows.maxCoeff());
    }
}

}  // namespace hilda::lie
