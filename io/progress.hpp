// SPDX-License-Identifier: GPL-3.0-or-later
/// Progress of a long computation on stderr, with the remaining time.

#pragma once

#include <chrono>
#include <limits>
#include <string>

namespace hilda::io {

/// A duration in the units that matter: "12 s" below 100 s, "12 min" below 100 min, "5 h 20 min" below 48 h,
/// "3 d 4 h"
std::string duration_text(double seconds);

/// On a terminal one line, which is rewritten at most five times per second and cut to the width of the
/// terminal. Where stderr is not a terminal, for example in a batch job, a new line each minute, the first
/// one after a minute
class ProgressLine {
public:
    using Clock = std::chrono::steady_clock;

    /// Shows nothing if `quiet` is set.
    explicit ProgressLine(bool quiet);
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    ~ProgressLine() { clear(); }

    bool is_shown() const { return shown; }
    /// Whether the line may be written now. Callers that would compute the text in vain ask first.
    bool is_due(Clock::time_point now = Clock::now()) const;
    /// The completed share of the work, in [0, 1]. From here on a line ends with it and with the remaining
    /// wall time:
    ///     T (1 - share) / (share - at_begin) - (now - t)
    /// t: time of the last change of the share, T: from the construction to t. `at_begin`: share that was
    /// complete before the construction, as in a resumed run. Without the remaining time where it is not
    /// known: no work has been completed, or the estimate has passed.
    void completed(double share, double at_begin = 0, Clock::time_point now = Clock::now());
    /// Writes the line if it is due.
    void show(const std::string& text, Clock::time_point now = Clock::now());
    /// Removes the line from a terminal, before other messages.
    void clear();
    /// Wall time since the construction [s]
    double seconds(Clock::time_point now = Clock::now()) const
    {
        return std::chrono::duration<double>(now - begin).count();
    }

private:
    std::string completion(Clock::time_point now) const;

    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    const bool shown, on_terminal;
    const Clock::time_point begin = Clock::now();
    Clock::time_point last = begin;
    double share = unknown;
    double total_seconds = unknown;  ///< estimated wall time from the construction to the end
    bool visible = false;
};

}  // namespace hilda::io
