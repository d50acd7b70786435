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

namespace {

// Newton iterations of a step with redundant rows. Residuals in the direction of an eigenvalue σ of D⁻¹ S
// decrease by ε/(σ + ε) in each of them: fast unless the configuration is almost singular.
constexpr int most_redundant = 6;
// Corrections of such a step may grow up to this factor near a singular configuration. The largest measured
// is 5.
constexpr double largest_growth = 100;
// The shift ε = 10 (h rate)², rate² = max(|ω̄|², |ω̄̇|). In a step across a singular configuration an
// eigenvalue σ of D⁻¹ S changes by about (h rate)² and the frozen matrix differs from that of the end of the
// step by as much. A smaller factor than 4 lets the corrections grow; a larger one increases the error of the
// crossing, which is proportional to ε.
constexpr double squared_rates = 10;
// Limits the error of a correction in regular directions for large steps and fast rotors.
constexpr double largest_shift = 0.01;

}  // namespace

NewtonStep::NewtonStep(const System& model, const Settings& settings)
    : model(model), mass(model.mass()), bodies(model.bodies()), settings(settings),
      most_iterations(model.keeps_redundant_rows() ? std::min(settings.max_iterations, most_redundant)
                                                   : settings.max_iterations),
      loads(bodies)
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

bool NewtonStep::has_history(const State& x) const
{
    return !x.internal_state.empty() && model.internal_states_are_history();
}

void NewtonStep::refuse_history(const State& x, std::string_view scheme, std::string_view why) const
{
    if (has_history(x)) throw InvalidInput("integrator " + std::string(scheme) + ": " + std::string(why));
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

void NewtonStep::start_redundant()
{
    if (model.keeps_redundant_rows()) constraint_part(z).setZero();
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
    if (k == 1) first_correction = correction;
    const double rate = k > 1 ? correction / before : 0;
    const double most = std::max(settings.tolerance, 4 * ulp);
    if (correction < most) {
        // With a rate up to 1/2 the error that remains is not larger than the correction.
        constexpr double fast = 0.5, stagnant = 0.95;
        if (rate <= fast || rate > stagnant || correction * rate < most * (1 - rate) || k == most_iterations)
            return true;
    }
    if (model.keeps_redundant_rows() && k == most_iterations)
        return correction <= largest_growth * first_correction;
    return k > 2 && correction > 0.5 * before && correction < 1e3 * ulp;
}

double NewtonStep::shift(double h) const
{
    if (!model.keeps_redundant_rows()) return 0;
    double square = 0;  // of the rate
    for (const Motion& body : x_n.body)
        square = std::max({square, body.omega_bar.squaredNorm(), body.omegadot_bar.norm()});
    return std::min(squared_rates * square * h * h, largest_shift);
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
    what << scheme << ": correction " << correction << " after " << most_iterations << " iterations";
    NoConvergence failure(what.str(), correction, most_iterations);
    if (first_correction > 0 && most_iterations > 1)  // of converged()
        failure.rate = std::pow(correction / first_correction, 1. / (most_iterations - 1));
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
