// SPDX-License-Identifier: GPL-3.0-or-later
/// Progress line on a terminal.

#pragma once

#include <chrono>
#include <string>

namespace hilda::io {

/// One line on the terminal (stderr), which is rewritten at most five times per second and cut to the width
/// of the terminal
class ProgressLine {
public:
    using Clock = std::chrono::steady_clock;

    /// Shows nothing if `quiet` is set or stderr is not a terminal.
    explicit ProgressLine(bool quiet);
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    ~ProgressLine() { clear(); }

    bool is_shown() const { return shown; }
    /// Whether the line may be rewritten now. Callers that would compute the text in vain ask first.
    bool is_due(Clock::time_point now = Clock::now()) const;
    /// Writes the line if it is due.
    void show(const std::string& text, Clock::time_point now = Clock::now());
    /// Removes the line, before other messages.
    void clear();
    /// Wall time since the construction [s]
    double seconds(Clock::time_point now = Clock::now()) const
    {
        return std::chrono::duration<double>(now - begin).count();
    }

private:
    const bool shown;
    const Clock::time_point begin = Clock::now();
    Clock::time_point last = begin;
    bool visible = false;
};

}  // namespace hilda::io
