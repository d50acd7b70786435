// SPDX-License-Identifier: GPL-3.0-or-later
/// Progress of a run on a terminal.

#pragma once

#include "granular/case/case_file.hpp"

#include <unistd.h>
#include <chrono>
#include <cstdio>

namespace hilda::granular {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point t)
{
    return std::chrono::duration<double>(Clock::now() - t).count();
}

/// One line on a terminal, rewritten at most five times a second
class Progress {
public:
    explicit Progress(bool quiet) : shown(!quiet && isatty(STDERR_FILENO) != 0) {}
    void update(const Case& c, double rate)
    {
        if (!shown || seconds_since(last) < 0.2) return;
        last = Clock::now();
        const double left =
            rate > 0 ? (c.end - c.world->t()) / c.h * static_cast<double>(c.world->count()) / rate : 0;
        std::fprintf(stderr, "\rhilda: t = %.4g of %.4g s, %.3g million particle-steps/s, %.0f s left   ",
                     c.world->t(), c.end, 1e-6 * rate, left);
    }
    void clear() const
    {
        if (shown) std::fprintf(stderr, "\r%78s\r", "");
    }

private:
    bool shown;
    Clock::time_point last = Clock::now();
};

}  // namespace hilda::granular
