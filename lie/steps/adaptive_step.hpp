// SPDX-License-Identifier: GPL-3.0-or-later
/// One-step methods on the Lie group with error control and dense output.

#pragma once

#include "lie/schemes.hpp"
#include "lie/steps/radau_step.hpp"
#include "lie/steps/runge_kutta_step.hpp"
#include "lie/steps/step_control.hpp"
#include "lie/steps/switch_search.hpp"

#include <memory>
#include <string>
#include <utility>

namespace hilda::lie {

/// Internal steps of a method, chosen from rtol and atol. Method is RungeKuttaStep, TreeRungeKuttaStep or
/// RadauStep. step() evaluates the continuous extension at its end, so that the output instants do not
/// affect the internal steps.
///
/// The last internal step contains the time of the node or ends there. Its stages, its end and the controller
/// are in State::history of the node: a run continues from there with the same digits. The poses and
/// velocities of a node inside the internal step are projected onto the constraints; accelerations and
/// multipliers are those of the saddle system at the node.
///
/// No body turns by more than 2 rad in an internal step at its initial angular velocity, or 1 rad if the
/// system counts revolutions. A step is repeated with a smaller length if its error estimate exceeds the
/// tolerance, if it fails, or if its end turns faster than twice that limit. The pivots of the linear solver
/// are then those of its first attempt, so that the rejected attempt has no effect on the digits.
///
/// A step ends where a load or a prescribed motion is not smooth: at the break points of time
/// (System::smooth_until) and at the zeros of switching functions (System::switching), which are located on
/// the step and hit from the side on which it began. The state is then moved to the other side, over a time
/// of rounding errors; prescribed velocities that jump there change the velocities by an impulse. The next
/// step has the length of a start.
template <class Method>
class AdaptiveStep final : public Method {
public:
    /// `more` are further arguments of the constructor of the method. Throws InvalidInput if rtol or atol is
    /// not in [1e-14, 0.1].
    template <class... More>
    AdaptiveStep(const System& model, const Settings& settings, const More&... more)
        : Method(model, settings, more...), switches(model)
    {
        set_tolerance_limits();
    }

    /// Throws NumericalFailure "step_too_small" if the error estimate of a step of the length of rounding
    /// errors exceeds the tolerance, or if 1000 internal steps cover less than h/1e6. A failure of such a
    /// step is passed on, with its length. Throws InvalidInput if loads depend on a history
    /// (System::internal_states_are_history): it is constant during a step.
    int step(State& x, double h) override;
    bool chooses_internal_steps() const override { return true; }

private:
    using Method::assemble_once, Method::bodies, Method::K, Method::model, Method::place,
        Method::refuse_history, Method::scheme_name, Method::set_accelerations, Method::set_slope,
        Method::settings, Method::unreached, Method::x_n;

    void set_tolerance_limits();
    void start();
    void choose_first_step(double smallest);
    int internal_step(double interval);
    /// One attempt from x_n to `end`. Sets the norm of its error estimate; infinite if it failed.
    int try_step(double h, bool again, double& norm);
    void set_node(State& x, double t);
    /// Largest length of a step from x_n [s]
    double limit() const;
    /// Turn of a body in the last step at the angular velocity of its end, over that of limit()
    double turn_over_limit(double h) const;
    /// The length of a step of at most h [s]: to a break point of time, if there is one; otherwise at_break
    /// is 0
    struct Cut {
        double h, at_break = 0;
    };
    Cut next_end(double h) const;
    /// Moves `end`, which lies before a break point of time, to its other side.
    void pass_break(double t);
    /// The place, from 0 to 1, before the first zero of a switching function in the last step; 1 if there is
    /// none, or if it is at an end of the step
    double place_of_switch(double h, double length_before, double smallest);
    /// Moves `end`, which lies before a zero of a switching function, to its other side. `longest` is the
    /// longer one of the last two steps.
    void pass_switch(double longest);
    /// Restores the pivots of the first attempt.
    void restore_pivots(double h);
    [[noreturn]] void fail(double h, double norm) const;
    /// Calls block(numbers, count) for the numbers that continue the steps.
    template <class Block>
    void transfer(const Block& block);

    double rtol = 0, atol = 0, largest_turn = 0;
    SwitchSearch switches;
    State end;          ///< of the last internal step, which starts at x_n
    double length = 0;  ///< of that step [s]; 0 at a start
    bool has_all_stages = false;
    StepControl control;
    State node;  ///< workspace: a state inside the step
    Eigen::VectorXd tolerance, size, change, rate, next_rate;
    State pivots_before;         ///< the pivots at the beginning of the step
    long factorizations = 0;     ///< at the time of pivots_before
    std::string status, reason;  ///< of the last attempt if it failed; otherwise empty
};

extern template class AdaptiveStep<RungeKuttaStep>;
extern template class AdaptiveStep<TreeRungeKuttaStep>;
extern template class AdaptiveStep<RadauStep>;

/// Adds a method to the list: with a fixed step, and AdaptiveStep as its adaptive form. `more` are functions
/// that return the further arguments of the constructor of the method.
template <class Method, auto... more>
bool register_with_adaptive_steps(Scheme scheme)
{
    Scheme adaptive = scheme;
    adaptive.adaptive = true;
    adaptive.supports = adaptive.supports.without({Feature::history});
    adaptive.uses.insert(adaptive.uses.end(), {"--rtol", "--atol", "--max-step"});
    adaptive.construct = [](const System& system, const Settings& settings) -> std::unique_ptr<Integrator> {
        return std::make_unique<AdaptiveStep<Method>>(system, settings, more()...);
    };
    scheme.adaptive_form = std::make_shared<const Scheme>(std::move(adaptive));
    scheme.construct = [](const System& system, const Settings& settings) -> std::unique_ptr<Integrator> {
        return std::make_unique<Method>(system, settings, more()...);
    };
    return add_scheme(std::move(scheme));
}

}  // namespace hilda::lie
