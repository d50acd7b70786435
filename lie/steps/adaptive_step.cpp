// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/adaptive_step.hpp"

#include "lie/check.hpp"
#include "lie/steps/state_numbers.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace hilda::lie {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

template <class Method>
void AdaptiveStep<Method>::set_tolerance_limits()
{
    const Tolerances checked(settings, scheme_name());
    rtol = checked.rtol, atol = checked.atol;
    for (Eigen::VectorXd* v : {&tolerance, &change, &rate, &next_rate}) v->setZero(12 * bodies);
}

template <class Method>
int AdaptiveStep<Method>::step(State& x, double h)
{
    refuse_history(x, scheme_name(),
                   "adaptive steps do not support loads that depend on a history, such as friction; use a "
                   "fixed step");
    copy(x, end), copy(x, x_n), copy(x, node);
    const auto numbers = [this](const auto& block) { transfer(block); };
    if (x.history.size() == 0)
        start(x);
    else
        read_history(x, scheme_name(), numbers);
    const double t = x.t + h;
    int iterations = 0;
    Progress progress(end.t, h);
    while (end.t < t) {
        if (settings.stop != nullptr && settings.stop()) throw Interrupted();
        iterations += internal_step(h);
        if (progress.has_stalled(end.t)) fail(length, control.last_error);
    }
    set_node(x, t);
    write_history(x, numbers);
    return iterations;
}

template <class Method>
template <class Block>
void AdaptiveStep<Method>::transfer(const Block& block)
{
    for (double* number : {&x_n.t, &end.t, &length, &control.h, &control.last_error}) block(number, 1);
    transfer_integer(has_all_stages, block);
    lie::transfer(x_n, block);
    lie::transfer(end, block);
    this->transfer_stages(block);
}

template <class Method>
void AdaptiveStep<Method>::start(const State& x)
{
    length = 0;
    has_all_stages = false;
    control = {};
    this->begin_run();
    theta.setZero();
    set_slope(x_n, rate);
    set_tolerances(x_n, x_n, rtol, atol, tolerance);
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x.body[i];
        change.segment<12>(12 * i) << body.r, Vec3::Zero(), body.rdot, body.omega_bar;
    }
    const FirstStep first{rms_over(tolerance, change), rms_over(tolerance, rate)};
    const double euler = std::min(first.euler(), limit());
    change = euler * rate;
    place(node, change);
    node.t = x_n.t + euler;
    try {
        model.update_alpha(node);
        set_accelerations(node);
        set_slope(node, next_rate);
        change = (next_rate - rate) / euler;
        control.h = first.of_order(this->control_order(), rms_over(tolerance, change));
    } catch (const NumericalFailure&) {
        control.h = 0.01 * euler;
    }
    if (!(control.h > 0)) control.h = euler;
}

template <class Method>
int AdaptiveStep<Method>::internal_step(double interval)
{
    copy(end, x_n);
    this->begin_internal_step();
    if (!K.is_condensed() && K.pivots().body.empty()) assemble_once(x_n);
    if (K.factorizations() != factorizations) {
        pivots_before = K.pivots();
        factorizations = K.factorizations();
    }
    const double smallest =
        std::max(16 * std::numeric_limits<double>::epsilon() * std::abs(x_n.t), 1e-14 * interval);
    bool again = length == 0;
    for (double norm = 0;; again = true) {
        const double h = std::min(control.h, limit());
        const int k = try_step(h, again, norm);
        if (norm <= 1) {
            length = h;
            has_all_stages = false;
            control.accept(h, norm, this->control_order());
            control.h = std::min(control.h, h * this->most_growth());
            return k;
        }
        if (!(h > smallest)) fail(h, norm);
        if (K.factorizations() != factorizations) {
            this->choose_pivots(pivots_before.body.empty() ? x_n : pivots_before, h);
            factorizations = K.factorizations();
        }
        control.reject(h, norm, this->control_order());
        if (settings.stop != nullptr && settings.stop()) throw Interrupted();
    }
}

template <class Method>
int AdaptiveStep<Method>::try_step(double h, bool again, double& norm)
{
    norm = infinity;
    status.clear(), reason.clear();
    copy(x_n, end);
    try {
        typename Method::Attempt step(end, x_n);
        const int k = this->attempt(end, h, rtol, atol, again, tolerance, norm);
        if (!(norm <= 1)) return 0;
        model.accepted(x_n, end);
        this->accept_stages(h);
        return this->done(step, k);
    } catch (const NumericalFailure& failure) {
        norm = infinity;
        status = failure.status, reason = failure.what();
        return 0;
    }
}

template <class Method>
void AdaptiveStep<Method>::set_node(State& x, double t)
{
    if (t == end.t) return copy(end, x);
    if (!has_all_stages) {
        copy(x_n, node);
        this->add_stages(node, length);
        has_all_stages = true;
    }
    copy(x_n, node);
    this->interpolate(node, (t - x_n.t) / length, length);
    node.t = t;
    model.accepted(x_n, node);
    copy(node, x);
}

template <class Method>
double AdaptiveStep<Method>::limit() const
{
    double fastest = 0;
    for (const Motion& body : x_n.body) fastest = std::max(fastest, body.omega_bar.squaredNorm());
    return largest_internal_turn / std::sqrt(fastest);
}

template <class Method>
void AdaptiveStep<Method>::fail(double h, double norm) const
{
    std::ostringstream what;
    what.precision(3);
    what << scheme_name() << " at t = " << x_n.t << " s: ";
    if (norm <= 1)
        what << Progress::interval << " steps cover less than " << Progress::least
             << " of the distance of two nodes; ";
    if (!status.empty())
        what << "a step of " << h << " s fails: " << reason;
    else
        what << "a step of " << h << " s has "
             << (unreached > 0 ? "no solution: Newton's method does not reach " : "")
             << "an error estimate of " << (unreached > 0 ? unreached : norm) << " times the tolerance (rtol "
             << rtol << ", atol " << atol
             << "); use larger tolerances, or check the loads for discontinuities";
    throw NumericalFailure(status.empty() ? "step_too_small" : status, what.str());
}

template class AdaptiveStep<RungeKuttaStep>;
template class AdaptiveStep<RadauStep>;

}  // namespace hilda::lie
