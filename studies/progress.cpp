// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/progress.hpp"

#include "studies/message.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>

namespace hilda::studies {

Progress::Progress(bool quiet, double t_end, long steps, long first_step)
    : show(!quiet && isatty(STDERR_FILENO) != 0), t_end(t_end), steps(steps), first_step(first_step)
{}

void Progress::update(Clock::time_point now, double t, long n, const lie::Statistics& s)
{
    if (!show || now - last < std::chrono::milliseconds(200)) return;
    last = now;
    const double seconds = std::chrono::duration<double>(now - begin).count();
    const double rate = static_cast<double>(n - first_step) / seconds;
    message(fmt::format("\rt = {:.3f} / {:g} s, {:.0f} steps/s, {:.1f} iterations/step, {:.0f} s left\033[K",
                        t, t_end, rate,
                        static_cast<double>(s.iterations) / static_cast<double>(std::max(1L, s.steps)),
                        static_cast<double>(steps - n) / std::max(rate, 1e-9)));
    visible = true;
}

void Progress::clear()
{
    if (visible) message("\r\033[K");
    visible = false;
}

}  // namespace hilda::studies
