// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/adaptive_step.hpp"

#include "lie/check.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace hilda::lie {

namespace {

// A run ends if this number of internal steps covers less than a fraction of the distance of two nodes.
constexpr long check_interval = 1000;
constexpr double least_progress = 1e-6;

constexpr double infinity = std::numeric_limits<double>::infinity();

double checked(const Tableau& tableau, const char* name, double tolerance)
{
    if (!(tolerance >= 1e-14 && tolerance <= 0.1))
        reject("integrator " + tableau.name, std::string(name) + " must be from 1e-14 to 0.1", tolerance);
    return tolerance;
}

/// Copies all but the history.
void copy(const State& from, State& to)
{
    to.t = from.t;
    to.body = from.body;
    to.alpha = from.alpha;
    to.lambda = from.lambda;
    to.discrete_state = from.discrete_state;
    to.internal_state = from.internal_state;
}

}  // namespace

AdaptiveStep::AdaptiveStep(const System& model, const Settings& settings, const Tableau& tableau)
    : RungeKuttaStep(model, settings, tableau), rtol(checked(tableau, "rtol", settings.rtol)),
      atol(settings.atol > 0 ? checked(tableau, "atol", settings.atol) : rtol), tolerance(12 * bodies),
      change(12 * bodies)
{}

int AdaptiveStep::step(State& x, double h)
{
    if (x.internal_state.size() > 0 && model.internal_states_are_history())
        reject("integrator " + tableau.name,
               "adaptive steps do not support loads that depend on a history, such as friction; use a fixed "
               "step; number of internal states",
               x.internal_state.size());
    copy(x, end), copy(x, x_n), copy(x, node);
    Eigen::Index size = 0;
    transfer([&](const double*, Eigen::Index count) { size += count; });
    if (x.history.size() == 0) {
        start(x);
    } else {
        if (x.history.size() != size)
            reject("integrator " + tableau.name, "State::history must be that of the same scheme; its size",
                   x.history.size());
        const double* from = x.history.data();
        transfer([&](double* numbers, Eigen::Index count) {
            std::copy_n(from, count, numbers);
            from += count;
        });
    }
    const double t = x.t + h;
    int iterations = 0;
    double checked = end.t;
    for (long n = 1; end.t < t; ++n) {
        if (settings.stop != nullptr && settings.stop()) throw Interrupted();
        iterations += internal_step(h);
        if (n % check_interval != 0) continue;
        if (end.t - checked < least_progress * h) fail(length, control.last_error);
        checked = end.t;
    }
    set_node(x, t);
    x.history.resize(size);
    double* to = x.history.data();
    transfer([&](const double* numbers, Eigen::Index count) { to = std::copy_n(numbers, count, to); });
    return iterations;
}

template <class Block>
void AdaptiveStep::transfer(const Block& block)
{
    static_assert(sizeof(Motion) == 24 * sizeof(double), "a motion consists of 24 numbers without padding");
    for (double* number : {&x_n.t, &end.t, &length, &control.h, &control.last_error}) block(number, 1);
    const auto integer = [&](auto& value) {
        auto number = static_cast<double>(value);
        block(&number, 1);
        value = static_cast<std::decay_t<decltype(value)>>(number);
    };
    integer(has_all_stages);
    for (State* x : {&x_n, &end}) {
        if (bodies > 0) block(x->body[0].r.data(), 24 * bodies);
        block(x->alpha.data(), x->alpha.size());
        block(x->lambda.data(), x->lambda.size());
        for (int& state : x->discrete_state) integer(state);
        block(x->internal_state.data(), static_cast<Eigen::Index>(x->internal_state.size()));
    }
    block(slope.data(), slope.size());
}

void AdaptiveStep::start(const State& x)
{
    length = 0;
    has_all_stages = false;
    control = {};
    theta.setZero();
    set_slope(x_n, slope.col(0));
    set_tolerances(x_n, x_n, rtol, atol, tolerance);
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x.body[i];
        change.segment<12>(12 * i) << body.r, Vec3::Zero(), body.rdot, body.omega_bar;
    }
    const FirstStep first{rms(change), rms(slope.col(0))};
    const double euler = std::min(first.euler(), limit());
    change = euler * slope.col(0);
    place(node, change);
    node.t = x_n.t + euler;
    try {
        model.update_alpha(node);
        set_accelerations(node);
        set_slope(node, slope.col(1));
        change = (slope.col(1) - slope.col(0)) / euler;
        control.h = first.of_order(tableau.order, rms(change));
    } catch (const NumericalFailure&) {
        control.h = 0.01 * euler;
    }
    if (!(control.h > 0)) control.h = euler;
}

int AdaptiveStep::internal_step(double interval)
{
    copy(end, x_n);
    if (!K.is_condensed() && K.pivots().body.empty()) assemble_once(x_n);
    if (K.factorizations() != factorizations) {
        pivots_before = K.pivots();
        factorizations = K.factorizations();
    }
    const double smallest =
        std::max(16 * std::numeric_limits<double>::epsilon() * std::abs(x_n.t), 1e-14 * interval);
    for (double norm = 0;;) {
        const double h = std::min(control.h, limit());
        const int k = attempt(h, norm);
        if (norm <= 1) {
            length = h;
            has_all_stages = false;
            control.accept(h, norm, tableau.order);
            return k;
        }
        if (!(h > smallest)) fail(h, norm);
        if (K.factorizations() != factorizations) {
            choose_pivots(pivots_before.body.empty() ? x_n : pivots_before, h);
            factorizations = K.factorizations();
        }
        control.reject(h, norm, tableau.order);
        if (settings.stop != nullptr && settings.stop()) throw Interrupted();
    }
}

int AdaptiveStep::attempt(double h, double& norm)
{
    norm = infinity;
    status.clear(), reason.clear();
    copy(x_n, end);
    try {
        Attempt step(end, x_n);
        const int k = advance(end, h);
        set_tolerances(x_n, end, rtol, atol, tolerance);
        norm = error(h, tolerance);
        if (!(norm <= 1)) return 0;
        model.accepted(x_n, end);
        return done(step, k);
    } catch (const NumericalFailure& failure) {
        norm = infinity;
        status = failure.status, reason = failure.what();
        return 0;
    }
}

void AdaptiveStep::set_node(State& x, double t)
{
    if (t == end.t) return copy(end, x);
    if (!has_all_stages) {
        copy(x_n, node);
        add_stages(node, length);
        has_all_stages = true;
    }
    copy(x_n, node);
    interpolate(node, (t - x_n.t) / length, length);
    node.t = t;
    model.accepted(x_n, node);
    copy(node, x);
}

double AdaptiveStep::limit() const
{
    constexpr double largest_turn = 2;  // [rad]; J_r is singular at 2π
    double fastest = 0;
    for (const Motion& body : x_n.body) fastest = std::max(fastest, body.omega_bar.squaredNorm());
    return largest_turn / std::sqrt(fastest);
}

void AdaptiveStep::fail(double h, double norm) const
{
    std::ostringstream what;
    what.precision(3);
    what << tableau.name << " at t = " << x_n.t << " s: ";
    if (norm <= 1)
        what << check_interval << " steps cover less than " << least_progress
             << " of the distance of two nodes; ";
    if (reason.empty())
        what << "a step of " << h << " s has an error estimate of " << norm << " times the tolerance (rtol "
             << rtol << ", atol " << atol
             << "); use larger tolerances, or check the loads for discontinuities";
    else
        what << "a step of " << h << " s fails: " << reason;
    throw NumericalFailure(status.empty() ? "step_too_small" : status, what.str());
}

double AdaptiveStep::rms(const Eigen::VectorXd& of) const
{
    return std::sqrt(of.cwiseQuotient(tolerance).squaredNorm() / static_cast<double>(of.size()));
}

}  // namespace hilda::lie
