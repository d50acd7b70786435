// SPDX-License-Identifier: GPL-3.0-or-later
/// Time integration: a scheme is applied to a start for the nodes of a time grid.

#pragma once

#include "lie/check.hpp"
#include "lie/state.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace hilda::lie {

class Integrator;

/// A failure that an observer found at a node, after it was passed to the observers before
class NodeFailure : public NumericalFailure {
    using NumericalFailure::NumericalFailure;
};

/// The nodes t_n = t_0 + n h, n = 0 … steps. The nodes at multiples of `interval`, and the last node, are
/// output rows.
struct TimeGrid {
    double h = 1e-3;  ///< [s]
    long steps = 0;
    long interval = 1;  ///< nodes from one output row to the next

    /// The grid from 0 to the first node at or after t_end, with the output interval ceil(dt/h) (dt = 0: each
    /// node). t_end and dt are matched exactly if they are multiples of h up to rounding. Throws InvalidInput
    /// if h is not positive, t_end or dt is negative, one of them is not finite, or the number of steps
    /// exceeds 1e15.
    static TimeGrid over(double t_end, double h, double dt = 0);

    bool is_row(long n) const { return n % interval == 0 || n == steps; }
};

/// Receives each node when it is complete: velocities, accelerations and multipliers are those of its time.
class Observer {
public:
    virtual ~Observer() = default;
    /// Node n, and the number of iterations of the step that ends there (0 at the start). NodeFailure ends
    /// the run.
    virtual void accepted(const State& node, long n, int iterations) = 0;
};

/// The output rows of a run. They have no State::history: a run cannot be continued from them.
struct Trajectory {
    std::vector<State> row;
};

/// Copies the output rows of a run. The grid must outlive it: a run that ends earlier shortens its grid.
class TrajectoryRecorder final : public Observer {
public:
    explicit TrajectoryRecorder(const TimeGrid& grid) : grid(grid) {}
    explicit TrajectoryRecorder(TimeGrid&& grid) = delete;
    void accepted(const State& node, long n, int iterations) override;

    Trajectory trajectory;

private:
    const TimeGrid& grid;
};

/// A time integration in progress. It holds the current node; a run can be saved between two steps and
/// resumed.
class March {
public:
    /// Starts at node n with the state x at time x.t. n > 0 resumes an earlier march; `iterations` is that of
    /// its last step.
    March(State x, Integrator& integrator, double h, long n = 0, int iterations = 0);

    /// Computes one step, and passes the node at its beginning to the observers. On an exception the
    /// march remains at its node. Throws NumericalFailure "step_too_large" if a body rotates by π or more in
    /// the step, except with a scheme that chooses internal steps.
    void advance(std::span<Observer* const> observers);

    /// Passes the current node to the observers: the end of a run. The march remains at this node.
    void finish(std::span<Observer* const> observers);

    const State& node() const { return x; }
    /// Sets internal states of the node, from index `first` on, for loads that are computed outside of the
    /// system and constant in a step.
    void set_internal_states(std::size_t first, std::span<const double> values);
    /// Replaces the state of the node, except for its time.
    void set_node(const State& node);
    long number() const { return n; }
    int iterations_of_last_step() const { return iterations; }

private:
    int try_step(State& after);
    void refuse_half_turns(const State& before, const State& to) const;
    double time(long node) const;  ///< node · h [s]

    State x, after;
    State complete;  ///< x with the velocities, accelerations and multipliers that its step computes
    Integrator& integrator;
    const double h, t_0;
    long n;
    int iterations;
};

/// Integrates over the whole grid and returns its output rows.
Trajectory march(State x, Integrator& integrator, const TimeGrid& grid,
                 std::span<Observer* const> observers = {});

}  // namespace hilda::lie
