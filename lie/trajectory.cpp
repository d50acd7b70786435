// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/trajectory.hpp"

#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

namespace hilda::lie {

namespace {

/// Throws if the state of a body is not finite, or so large that its energy would overflow.
void refuse_overflow(const System& system, const State& to)
{
    const Mass& mass = system.mass();
    for (size_t b = 0; b < to.body.size(); ++b) {
        const Motion& body = to.body[b];
        const double squares = mass.m[b] * (body.r.squaredNorm() + body.rdot.squaredNorm()) +
                               body.omega_bar.dot(mass.J_bar[b] * body.omega_bar);
        if (std::isfinite(squares + body.A.sum() + body.rddot.sum() + body.omegadot_bar.sum())) continue;
        const auto fault = [](const Vec3& x) { return !std::isfinite(x.squaredNorm()); };
        const char* const what = fault(body.r)           ? "position"
                                 : fault(body.rdot)      ? "velocity"
                                 : fault(body.omega_bar) ? "angular velocity"
                                 : !body.A.allFinite()   ? "orientation"
                                                         : "acceleration or energy";
        throw NonFinite(system.body_name(static_cast<int>(b)) + ": the " + what +
                        " after the step is not finite or overflows");
    }
}

/// Throws if the orientation of a body is not a rotation: an integrator from outside the library is wrong.
void refuse_distortion(const System& system, const State& to)
{
    constexpr double most = 1e-6;  // above the errors of normalised Euler parameters and of sums of rotations
    for (size_t b = 0; b < to.body.size(); ++b) {
        const Mat3& A = to.body[b].A;
        const double error = (A.transpose() * A - Mat3::Identity()).cwiseAbs().maxCoeff();
        if (error <= most && A.determinant() > 0) continue;
        std::ostringstream what;
        what.precision(3);
        what << system.body_name(static_cast<int>(b))
             << ": the orientation A after the step is not a rotation: the largest entry of A^T A - I is "
             << error << ", the limit " << most << ", and det A is " << A.determinant();
        throw NumericalFailure("not_a_rotation", what.str());
    }
}

}  // namespace

TimeGrid TimeGrid::over(double t_end, double h, double dt)
{
    if (!(h > 0) || !std::isfinite(h))
        reject("lie::TimeGrid", "the step h must be positive and finite [s]", h);
    if (!(t_end >= 0) || !std::isfinite(t_end))
        reject("lie::TimeGrid", "the end time must be finite and not negative [s]", t_end);
    if (!(dt >= 0) || !std::isfinite(dt))
        reject("lie::TimeGrid", "the output interval must be finite and not negative [s]", dt);
    if (t_end / h > 1e15)
        reject("lie::TimeGrid", "the number of steps must be at most 1e15; increase the step h", t_end / h);
    constexpr double slack = 1e-9;  // of a step, for the rounding of t_end / h and dt / h
    TimeGrid grid;
    grid.h = h;
    grid.steps = static_cast<long>(std::ceil(t_end / h - slack));
    grid.interval = std::max(1L, static_cast<long>(std::ceil(std::min(dt / h, 1e15) - slack)));
    return grid;
}

March::March(State x, Integrator& integrator, double h, long n, int iterations)
    : x(std::move(x)), after(this->x), integrator(integrator), h(h),
      t_0(n == 0 ? this->x.t : this->x.t - time(n)), n(n), iterations(iterations)
{}

void March::set_internal_states(std::size_t first, std::span<const double> values)
{
    std::copy(values.begin(), values.end(), x.internal_state.begin() + static_cast<std::ptrdiff_t>(first));
}

void March::set_node(const State& node)
{
    const double t = x.t;
    x = node;
    x.t = t;
}

// A sum of h would drift. If 1/h is an integer, node/(1/h) is the double nearest to a decimal such as 0.009;
// the product node · h is not.
double March::time(long node) const
{
    const double per_second = std::round(1 / h);
    const auto count = static_cast<double>(node);
    return per_second >= 1 && std::abs(per_second * h - 1) < 1e-14 ? count / per_second : count * h;
}

/// Throws if a body rotates by π or more in the step, at the angular velocity of its beginning or its end.
/// The turns of an angle that is followed from step to step would then be counted wrongly.
void March::refuse_half_turns(const State& before, const State& to) const
{
    for (size_t b = 0; b < to.body.size(); ++b) {
        const double angle = h * std::sqrt(std::max(before.body[b].omega_bar.squaredNorm(),
                                                    to.body[b].omega_bar.squaredNorm()));
        if (angle < std::numbers::pi) continue;
        std::ostringstream what;
        what.precision(3);
        what << integrator.system().body_name(static_cast<int>(b)) << " rotates by " << angle
             << " rad in one step, and the limit is pi; reduce the step";
        throw NumericalFailure("step_too_large", what.str());
    }
}

int March::try_step(State& to)
{
    to = x;
    // Also for its exception, a prescribed motion that jumps
    if (!integrator.chooses_internal_steps()) integrator.system().velocity_jumps(x.t, x.t + h);
    const int k = integrator.step(to, h);
    to.t = t_0 + time(n + 1);
    refuse_overflow(integrator.system(), to);
    refuse_distortion(integrator.system(), to);
    if (!integrator.chooses_internal_steps()) refuse_half_turns(x, to);
    return k;
}

void March::advance(std::span<Observer* const> observers)
{
    const int k = try_step(after);
    const State* node = &x;
    if (n > 0 && integrator.is_staggered()) {  // the start has its own accelerations and multipliers
        // A copy: x remains the beginning of the step if an observer throws.
        complete = x;
        integrator.fill_node(complete, after);
        node = &complete;
    }
    // Before the observers: if accepted() throws, finish() passes this node to them.
    if (!integrator.chooses_internal_steps()) integrator.system().accepted(*node, after);
    for (Observer* o : observers) o->accepted(*node, n, iterations);
    std::swap(x, after);
    ++n;
    iterations = k;
}

void March::finish(std::span<Observer* const> observers)
{
    State node = x;
    if (integrator.is_staggered() && n > 0) {
        // The multipliers, accelerations and node velocities of the last node follow from a further step. If
        // this step fails, the multipliers and accelerations of the node before are used.
        try {
            try_step(after);
            integrator.fill_node(node, after);
        } catch (const NumericalFailure&) {
        }
    }
    for (Observer* o : observers) o->accepted(node, n, iterations);
}

void TrajectoryRecorder::accepted(const State& node, long n, int /*iterations*/)
{
    if (!grid.is_row(n)) return;
    trajectory.row.push_back({.t = node.t,
                              .body = node.body,
                              .alpha = node.alpha,
                              .lambda = node.lambda,
                              .discrete_state = node.discrete_state,
                              .internal_state = node.internal_state,
                              .history = {},
                              .applied_loads = node.applied_loads,
                              .cone_forces = node.cone_forces,
                              .derived = node.derived});
}

Trajectory march(State x, Integrator& integrator, const TimeGrid& grid, std::span<Observer* const> observers)
{
    TrajectoryRecorder recorder(grid);
    std::vector<Observer*> all(observers.begin(), observers.end());
    all.push_back(&recorder);
    March progress(std::move(x), integrator, grid.h);
    while (progress.number() < grid.steps) progress.advance(all);
    progress.finish(all);
    return std::move(recorder.trajectory);
}

}  // namespace hilda::lie
