// SPDX-License-Identifier: GPL-3.0-or-later
/// One line on a terminal, rewritten at most five times a second.

#pragma once

#include "lie/integrator.hpp"

#include <chrono>

namespace hilda::studies {

class Progress {
public:
    using Clock = std::chrono::steady_clock;

    /// Shows nothing when stderr is no terminal or `quiet`.
    Progress(bool quiet, double t_end, long steps, long first_step);
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress() { clear(); }

    bool shown() const { return show; }
    /// t/T, steps per second, iterations per step, time left
    void update(Clock::time_point now, double t, long n, const lie::Statistics& statistics);
    /// Takes the line away, so that a message can stand there.
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
