// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/progress.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::run {

void Progress::update(Clock::time_point now, double t, long n, const lie::Statistics& s)
{
    if (!line.is_due(now)) return;
    const double rate = static_cast<double>(n - first_step) / line.seconds(now);
    const auto all = static_cast<double>(std::max(1L, steps));
    line.completed(static_cast<double>(n) / all, static_cast<double>(first_step) / all, now);
    line.show(fmt::format("t = {:.3f} / {:g} s, {:.0f} steps/s, {:.1f} iterations/step", t, t_end, rate,
                          static_cast<double>(s.iterations) / static_cast<double>(std::max(1L, s.steps))),
              now);
}

}  // namespace hilda::run
