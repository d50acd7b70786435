// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/progress.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

void Progress::update(Clock::time_point now, double t, long n, const lie::Statistics& s)
{
    if (!line.is_due(now)) return;
    const double rate = static_cast<double>(n - first_step) / line.seconds(now);
    line.show(
        fmt::format("t = {:.3f} / {:g} s, {:.0f} steps/s, {:.1f} iterations/step, {:.0f} s left", t, t_end,
                    rate, static_cast<double>(s.iterations) / static_cast<double>(std::max(1L, s.steps)),
                    static_cast<double>(steps - n) / std::max(rate, 1e-9)),
        now);
}

}  // namespace hilda::studies
