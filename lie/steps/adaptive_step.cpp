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
// Within this part of a step from its end, a zero of a switching function is at its end.
constexpr double at_end = 1e-9;
constexpr int most_located = 50;  // attempts to end a step at a zero

}  // namespace

template <class Method>
void AdaptiveStep<Method>::set_tolerance_limits()
{
    const Tolerances checked(settings, scheme_name());
    rtol = checked.rtol, atol = checked.atol;
    largest_turn = model.counts_turns() ? largest_counted_turn : largest_internal_turn;
    for (Eigen::VectorXd* v : {&tolerance, &size}) v->setZero(12 * bodies);
    for (Eigen::VectorXd* v : {&change, &rate, &next_rate}) v->setZero(this->variables());
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
        start();
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
void AdaptiveStep<Method>::start()
{
    length = 0;
    has_all_stages = false;
    control = {};
    this->begin_run();
}

/// Sets the first step from x_n at a start and behind a place where the equations are not smooth: an error
/// estimate that begins with the step before could be blind for what follows.
template <class Method>
void AdaptiveStep<Method>::choose_first_step(double smallest)
{
    this->begin_stages();
    set_slope(x_n, rate);
    set_tolerances(x_n, x_n, rtol, atol, tolerance);
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x_n.body[i];
        size.segment<12>(12 * i) << body.r, Vec3::Zero(), body.rdot, body.omega_bar;
    }
    const auto rms = [this](const Eigen::VectorXd& of) {
        return std::sqrt(this->square_over(tolerance, of) / static_cast<double>(tolerance.size()));
    };
    const FirstStep first{rms_over(tolerance, size), rms(rate)};
    const double euler = std::min(first.euler(), limit());
    change = euler * rate;
    place(node, change);
    node.t = x_n.t + euler;
    try {
        model.update_alpha(node);
        set_accelerations(node);
        set_slope(node, next_rate);
        change = (next_rate - rate) / euler;
        control.h = first.of_order(this->control_order(), rms(change));
    } catch (const NumericalFailure&) {
        control.h = 0.01 * euler;
    }
    if (!(control.h > 0)) control.h = std::max(euler, smallest);  // the square of a load may overflow
}

template <class Method>
int AdaptiveStep<Method>::internal_step(double interval)
{
    copy(end, x_n);
    const double smallest =
        std::max(16 * std::numeric_limits<double>::epsilon() * std::abs(x_n.t), 1e-14 * interval);
    if (control.h == 0) choose_first_step(smallest);
    this->begin_internal_step();
    if (!K.is_condensed() && K.pivots().body.empty()) assemble_once(x_n);
    if (K.factorizations() != factorizations) {
        pivots_before = K.pivots();
        factorizations = K.factorizations();
    }
    const double begun = length;
    double to_switch = infinity;  // time from x_n to the zero of a switching function
    bool again = length == 0;
    int located = 0;
    for (double norm = 0;; again = true) {
        if (settings.stop != nullptr && settings.stop()) throw Interrupted();
        const Cut cut = next_end(std::min({control.h, limit(), to_switch}));
        const double h = cut.h;
        if (!(h > 0)) {  // x_n is at a break point
            pass_break(cut.at_break);
            copy(end, x_n);
            choose_first_step(smallest);
            continue;
        }
        const int k = try_step(h, again, norm);
        if (norm <= 1) {
            if (const double turn = turn_over_limit(h); turn > 2) {
                control.h = h / turn;
                restore_pivots(h);
                continue;
            }
            if (const double s = place_of_switch(h, begun, smallest); s < 1 && ++located < most_located) {
                to_switch = s * h;
                restore_pivots(h);
                continue;
            }
            this->accept_stages(h);
            if (h == to_switch) pass_switch(std::max(h, begun));
            if (cut.at_break > 0) pass_break(cut.at_break);
            length = h;
            has_all_stages = false;
            control.accept(h, norm, this->control_order());
            control.h = std::min(control.h, h * this->most_growth());
            if (h == to_switch || cut.at_break > 0) control = {};
            return k;
        }
        if (!(h > smallest)) fail(h, norm);
        restore_pivots(h);
        control.reject(h, norm, this->control_order());
    }
}

template <class Method>
void AdaptiveStep<Method>::restore_pivots(double h)
{
    if (K.factorizations() == factorizations) return;
    this->choose_pivots(pivots_before.body.empty() ? x_n : pivots_before, h);
    factorizations = K.factorizations();
}

template <class Method>
auto AdaptiveStep<Method>::next_end(double h) const -> Cut
{
    const double t_end = x_n.t + h;
    const System::SmoothTime smooth = model.smooth_until(x_n.t, t_end);
    if (!smooth.is_break) return {smooth.end < t_end ? smooth.end - x_n.t : h};
    return {std::max(0., smooth.end - break_distance(smooth.end) - x_n.t), smooth.end};
}

template <class Method>
void AdaptiveStep<Method>::pass_break(double t)
{
    end.t = t + break_distance(t);
    assemble_once(end);
    this->finish(end, scheme_name());
}

template <class Method>
double AdaptiveStep<Method>::place_of_switch(double h, double length_before, double smallest)
{
    if (!switches.is_needed()) return 1;
    const SwitchSearch::Crossing crossing = switches.first(x_n, end, at_end * length_before / h);
    return crossing.s * h > smallest && crossing.s < 1 - at_end ? crossing.s : 1;
}

template <class Method>
void AdaptiveStep<Method>::pass_switch(double longest)
{
    if (switches.differ(x_n, end)) return;
    for (double d = 1e-15 * longest; d < 10 * at_end * longest; d *= 4) {
        copy(end, node);
        for (Motion& body : node.body) {
            body.r += d * body.rdot, body.A = body.A * exp(d * body.omega_bar);
            body.rdot += d * body.rddot, body.omega_bar += d * body.omegadot_bar;
        }
        node.t += d;
        if (!switches.differ(x_n, node)) continue;
        copy(node, end);
        assemble_once(end);
        this->finish(end, scheme_name());
        return;
    }
}

template <class Method>
double AdaptiveStep<Method>::turn_over_limit(double h) const
{
    double fastest = 0;
    for (const Motion& body : end.body) fastest = std::max(fastest, body.omega_bar.squaredNorm());
    return h * std::sqrt(fastest) / largest_turn;
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
    return std::min(largest_turn / std::sqrt(fastest), settings.longest_step());
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
template class AdaptiveStep<TreeRungeKuttaStep>;
template class AdaptiveStep<RadauStep>;

}  // namespace hilda::lie
