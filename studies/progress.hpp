// SPDX-License-Identifier: GPL-3.0-or-later
/// Progress line of a run on a terminal (stderr), updated at most five times per second.

#pragma once

#include "lie/statistics.hpp"

#include <chrono>

namespace hilda::studies {

class Progress {
public:
    using Clock = std::chrono::steady_clock;

    /// Shows nothing if stderr is not a terminal or `quiet` is set.
    Progress(bool quiet, double t_end, long steps, long first_step);
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress() { clear(); }

    bool shown() const { return show; }
    /// Shows time t of t_end [s], steps per second, iterations per step and estimated remaining time; n:
    /// number of the node.
    void update(Clock::time_point now, double t, long n, const lie::Statistics& statistics);
    /// Clears the line before other messages.
    void clear();

private:
    const bool show;
    const double t_end;
    const long steps, first_step;
    const Clock::time_point begin = Clock::now();
    Clock::time_point last = begin;
    bool visible = false;
};

}  // namespace hilda::studies
