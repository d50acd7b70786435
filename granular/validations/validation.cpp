// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/validation.hpp"

#include "io/message.hpp"

#include <algorithm>

namespace hilda::granular {

void ValidationWarnings::include(const std::string& run, const WatchRecord& record)
{
    if (record.warnings == 0) return;
    const auto same =
        std::find_if(runs.begin(), runs.end(), [&](const WarnedRun& r) { return r.name == run; });
    if (same == runs.end())
        runs.push_back({run, record});
    else
        same->record.include(record);
}

void ValidationWarnings::include(const ValidationWarnings& other)
{
    for (const WarnedRun& run : other.runs) include(run.name, run.record);
}

void ValidationWarnings::transfer(io::Archive& a)
{
    std::size_t count = runs.size();
    a.count(count, sizeof(WatchRecord));
    runs.resize(count);
    for (WarnedRun& run : runs) a.list(run.name), a.value(run.record);
}

std::vector<ValidationWarning> ValidationWarnings::all() const
{
    std::vector<ValidationWarning> lines;
    for (const WarnedRun& run : runs)
        for (const auto& [which, name] : watch_warnings)
            if ((run.record.warnings & which) != 0)
                lines.push_back({name, run.name + ": " + watch_warning(run.record, which)});
    return lines;
}

std::vector<ValidationWarning> ValidationWarnings::largest() const
{
    std::vector<ValidationWarning> lines;
    for (const auto& [which, name] : watch_warnings) {
        const WarnedRun* worst = nullptr;
        long others = -1;
        for (const WarnedRun& run : runs) {
            if ((run.record.warnings & which) == 0) continue;
            ++others;
            if (worst == nullptr || run.record.extreme(which) > worst->record.extreme(which)) worst = &run;
        }
        if (worst == nullptr) continue;
        lines.push_back({name, worst->name + ": " + watch_warning(worst->record, which)});
        if (others > 0) lines.back().text += " (less in " + io::counted(others, "other run") + ")";
    }
    return lines;
}

}  // namespace hilda::granular
