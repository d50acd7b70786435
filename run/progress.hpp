// SPDX-License-Identifier: GPL-3.0-or-later
/// Progress line of a run.

#pragma once

#include "io/progress.hpp"
#include "lie/statistics.hpp"

namespace hilda::run {

class Progress {
public:
    using Clock = io::ProgressLine::Clock;

    /// Shows nothing if `quiet` is set. first_step: number of the node at which the run begins
    Progress(bool quiet, double t_end, long steps, long first_step)
        : line(quiet), t_end(t_end), steps(steps), first_step(first_step)
    {}

    bool shown() const { return line.is_shown(); }
    /// Shows time t of t_end [s], steps per second, iterations per step, the completed share of the steps and
    /// the remaining time; n: number of the node.
    void update(Clock::time_point now, double t, long n, const lie::Statistics& statistics);
    /// Clears the line before other messages.
    void clear() { line.clear(); }

private:
    io::ProgressLine line;
    const double t_end;
    const long steps, first_step;
};

}  // namespace hilda::run
