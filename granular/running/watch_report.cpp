// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/running/watch_report.hpp"

#include <vector>

namespace hilda::granular {

namespace {

std::vector<double> components(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

io::Json watch_summary(const WatchRecord& w)
{
    std::vector<std::string> given;
    for (const auto& [which, status] : watch_warnings)
        if ((w.warnings & which) != 0) given.emplace_back(status);
    // w.work is that until the next step; the balance gives that at the last sample
    const double energy = w.kinetic + w.potential + w.normal + w.tangential,
                 work = w.work == 0 ? 0 : w.dissipated + energy - w.energy_offset;
    io::Json all;
    all["samples"] = static_cast<long>(w.samples);
    all["energy"] = {{"kinetic", w.kinetic},
                     {"potential", w.potential},
                     {"normal_springs", w.normal},
                     {"tangential_springs", w.tangential},
                     {"work", work},
                     {"dissipated", w.dissipated},
                     {"largest_kinetic", w.largest_kinetic},
                     {"largest_gain", w.largest_gain},
                     {"passive", w.is_driven == 0}};
    all["momentum"] = {{"linear", components(w.momentum)},
                       {"impulse", components(w.impulse)},
                       {"largest", w.largest_momentum},
                       {"largest_residual", w.largest_momentum_residual}};
    all["largest_overlap"] = w.largest_overlap;
    all["deep_fraction"] = w.deep_fraction;
    all["largest_deep_fraction"] = w.largest_deep_fraction;
    all["largest_displacement"] = w.largest_displacement;
    all["warnings"] = given;
    return all;
}

void report_watch(const WatchRecord& record, std::int64_t& known, bool strict,
                  const std::vector<std::string>& boundaries,
                  const std::function<void(const std::string&)>& warn)
{
    for (const auto& [which, status] : watch_warnings) {
        if ((record.warnings & ~known & which) == 0) continue;
        known |= which;
        const std::string text = watch_warning(record, which, boundaries);
        if (strict) throw StrictWarning(status, text + strict_suffix);
        warn(text);
    }
}

}  // namespace hilda::granular
