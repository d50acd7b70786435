// SPDX-License-Identifier: GPL-3.0-or-later
/// The interface of a time-stepping scheme. lie/schemes.hpp has the list of schemes.

#pragma once

#include "lie/statistics.hpp"

namespace hilda::lie {

struct State;
class System;

/// A time-stepping scheme for one system.
class Integrator {
public:
    Integrator() = default;
    Integrator(const Integrator&) = delete;
    Integrator& operator=(const Integrator&) = delete;
    virtual ~Integrator() = default;

    /// Advances x from t_n to t_{n+1} = t_n + h and returns the number of Newton iterations.
    ///
    /// If NumericalFailure is thrown, x is unchanged. A multi-step scheme stores its data in x.history. These
    /// data are valid for this scheme and this h only; x.history must be empty when the scheme or the step
    /// changes.
    virtual int step(State& x, double h) = 0;

    /// Whether a step computes λ_n, r̈_n, ω̄̇_n of the node at its beginning, as half-implicit schemes do.
    /// step() returns these values in its result, and fill_node() copies them to the node to which they
    /// belong.
    virtual bool is_staggered() const { return false; }
    /// Completes `node` at t_n from `after`, the result of the step from t_n to t_{n+1}.
    virtual void fill_node(State& /*node*/, const State& /*after*/) const {}
    /// For staggered schemes: whether an empty x.history marks a start, where λ, r̈, ω̄̇ of x are those at
    /// x.t.
    virtual bool keeps_history() const { return false; }

    /// The state in which the present pivots of the linear solver were chosen.
    ///
    /// The pivots affect the last digits of a result. They are the only data that a scheme may keep outside
    /// State. A restarted run calls choose_pivots() with this state and the step h to reproduce the digits.
    /// The default, no state, is for schemes whose first step from a saved node chooses the same pivots
    /// again.
    virtual const State* pivots() const { return nullptr; }
    /// Chooses the pivots in the state x for steps of the length h.
    virtual void choose_pivots(const State& /*x*/, double /*h*/) {}

    /// Sets the multipliers of a node if Settings::multipliers is false and the scheme leaves them out.
    virtual void set_multipliers(State& /*node*/) {}

    /// Whether a step of the length h consists of internal steps that the scheme chooses. Such a scheme calls
    /// System::accepted() for each of them and for its result.
    virtual bool chooses_internal_steps() const { return false; }

    virtual const System& system() const = 0;
    virtual Statistics statistics() const = 0;
};

}  // namespace hilda::lie
