// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/events.hpp"

#include "lie/bracket.hpp"
#include "lie/integrator.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace hilda::lie {

namespace {

int sign_of(double g) { return std::isnan(g) ? EventSearch::unknown : (g > 0) - (g < 0); }

/// Whether a change between two signs is an event of this direction. A zero at a node belongs to the step
/// that ends there.
bool counts(Event::Direction direction, int before, int now)
{
    if (before == EventSearch::unknown || now == EventSearch::unknown || before == 0 || now == before)
        return false;
    return direction == Event::both || (direction == Event::rising) == (before < 0);
}

[[noreturn]] void refuse(const Event& event, double t)
{
    std::ostringstream what;
    what << "the formula of the event '" << event.name << "' is not a number at t = " << t << " s";
    throw NumericalFailure("event_not_finite", what.str());
}

/// Sets positions and velocities to those at this share of the time from `from` to `to`, over which they
/// are linear.
void interpolate(const State& from, double share, State& to)
{
    for (std::size_t b = 0; b < to.body.size(); ++b) {
        const Motion& begin = from.body[b];
        Motion& m = to.body[b];
        m.r = begin.r + share * (m.r - begin.r);
        m.A = begin.A * exp(Vec3(share * log(begin.A.transpose() * m.A)));
        m.rdot = begin.rdot + share * (m.rdot - begin.rdot);
        m.omega_bar = begin.omega_bar + share * (m.omega_bar - begin.omega_bar);
    }
}

}  // namespace

EventSearch::~EventSearch() = default;

EventSearch::EventSearch(std::vector<Event> events, Make of, Values values)
    : all(std::move(events)), make(std::move(of)), values(std::move(values))
{
    saved.sign.assign(all.size(), unknown);
    saved.undefined.assign(all.size(), std::numeric_limits<double>::quiet_NaN());
    g.assign(all.size(), std::numeric_limits<double>::quiet_NaN());
    next_g = g;
}

bool EventSearch::node(const State& to, const Report& report)
{
    const double h = saved.node.body.empty() ? 0 : to.t - saved.node.t;
    zeros.clear();
    integrator.reset();
    next_sign = saved.sign;
    set_values(to);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const double now = next_g[k];
        const int sign = sign_of(now);
        if (h > 0 && counts(all[k].direction, saved.sign[k], sign)) {
            if (std::isnan(g[k])) g[k] = all[k].value(saved.node);  // of a resumed run
            if (std::isnan(g[k])) refuse(all[k], saved.node.t);
            zeros.push_back({sign == 0 ? h : locate(all[k], g[k], now, h), k, saved.sign[k] < 0});
        }
        // A function that is zero at a node passes through zero there or touches it: one event, whichever
        // sign follows.
        if (sign != unknown) next_sign[k] = sign;
    }
    std::stable_sort(zeros.begin(), zeros.end(), [](const Zero& a, const Zero& b) { return a.tau < b.tau; });
    states.clear();
    for (stop = 0; stop < zeros.size(); ++stop) {
        set_state_of(zeros[stop], to, h);
        states.push_back(x);
        if (all[zeros[stop].event].stops) break;
    }
    // An exception before this line, of a force or of the formula of an event, leaves the search at its node.
    saved.sign.swap(next_sign);
    g.swap(next_g);
    for (std::size_t k = 0; k < all.size(); ++k)
        if (std::isnan(g[k]) && std::isnan(saved.undefined[k])) saved.undefined[k] = to.t;
    for (std::size_t k = 0; k < states.size(); ++k) report({zeros[k].event, zeros[k].rises, states[k]});
    if (stop < zeros.size()) return true;
    saved.node = to;
    return false;
}

/// Sets next_g to the values at a node.
void EventSearch::set_values(const State& at)
{
    if (values) return values(at, next_g);
    for (std::size_t k = 0; k < all.size(); ++k) next_g[k] = all[k].value(at);
}

/// Sets x to the state at a zero.
void EventSearch::set_state_of(const Zero& zero, const State& to, double h)
{
    set_state(zero.tau, h);
    // The node differs from the state after a step of h if the loads changed at the last node and the scheme
    // is staggered: the zero may then be at the node alone.
    const Event& event = all[zero.event];
    const int sign = sign_of(event.value(to));
    if (zero.tau != h || sign == 0 || sign_of(event.value(x)) == sign) return;
    x = to;
    x.history.resize(0);
}

/// Time from the last node to the zero of g [s], to the last digits of t: the end of the bracket at which g
/// has its new sign, or is zero
double EventSearch::locate(const Event& event, double g_begin, double g_end, double h)
{
    const double tolerance = 4 * std::numeric_limits<double>::epsilon() * (std::abs(saved.node.t) + h);
    Bracket bracket(0, g_begin, h, g_end);
    try {
        narrow(bracket, tolerance, [&](double tau) {
            set_state(tau, h);
            return event.value(x);
        });
    } catch (const NumericalFailure& failure) {
        if (failure.status != "event_not_finite") throw;
        refuse(event, x.t);
    }
    return bracket.b;
}

/// Sets x to the complete state at this time after the last node.
void EventSearch::set_state(double tau, double h)
{
    // Accelerations follow from differences of velocities over the partial step.
    constexpr double least = 1e-8;
    const double step = std::max(tau, least * h);
    if (!integrator) integrator = make();
    x = saved.node;
    if (!integrator->chooses_internal_steps()) x.history.resize(0);
    integrator->step(x, step);
    x.t = saved.node.t + step;
    if (!integrator->chooses_internal_steps()) integrator->system().accepted(saved.node, x);
    if (integrator->is_staggered()) {
        after = x;
        integrator->step(after, step);
        integrator->fill_node(x, after);
    }
    x.history.resize(0);
    if (tau < step) interpolate(saved.node, tau / step, x);
    x.t = saved.node.t + tau;
}

}  // namespace hilda::lie
