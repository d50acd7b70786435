// SPDX-License-Identifier: GPL-3.0-or-later
/// From a start and a scheme to a trajectory.

#pragma once

#include "lie/integrator.hpp"

#include <span>

namespace hilda::lie {

/// Nodes t_n = t_0 + n h, n = 0 … steps; every so-many-th of them is a row of the trajectory.
struct TimeGrid {
    double h = 1e-3;  ///< [s]
    long steps = 0;
    long interval = 1;

    /// Nodes up to the first at or after t_end; of them every ceil(dt/h)-th is a row, each when dt is 0. Both
    /// are exact when they are multiples of h. InvalidInput when a number makes no sense.
    static TimeGrid over(double t_end, double h, double dt = 0);

    bool is_row(long n) const { return n % interval == 0 || n == steps; }
};

/// Watches nodes as they are accepted. A node comes with its velocities, accelerations and multipliers all at
/// its time.
class Observer {
public:
    virtual ~Observer() = default;
    /// n-th node; iterations of the step that led to it (0 at the start)
    virtual void accepted(const State& node, long n, int iterations) = 0;
};

struct Trajectory {
    std::vector<State> row;
};

/// A march in progress: holds the node it stands on, so that it can be written down between two steps and
/// gone on with.
class March {
public:
    /// From the node x with number n: x.t belongs to it. Give n > 0 only to go on with an earlier march.
    March(State x, Integrator& integrator, double h, long n = 0, int iterations = 0);

    /// Takes one step and tells the observers of the node it leaves. On a NumericalFailure the march stays
    /// where it was.
    void advance(std::span<Observer* const> observers);

    /// Tells the observers of the node it stands on, without leaving it: the end of a run.
    void finish(std::span<Observer* const> observers);

    const State& node() const { return x; }
    long number() const { return n; }
    int iterations_of_last_step() const { return iterations; }

private:
    int try_step(State& after);
    double time(long node) const;  ///< node h [s]

    State x, after;
    Integrator& integrator;
    const double h, t_0;
    long n;
    int iterations;
};

/// Runs over the whole grid and keeps its rows.
Trajectory march(State x, Integrator& integrator, const TimeGrid& grid,
                 std::span<Observer* const> observers = {});

}  // namespace hilda::lie
