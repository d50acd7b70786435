// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/groups.hpp"

#include "io/archive.hpp"

#include <algorithm>
#include <map>

namespace hilda::granular {

int Groups::number(const std::string& name)
{
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) {
        names.push_back(name);
        return static_cast<int>(names.size()) - 1;
    }
    return static_cast<int>(at - names.begin());
}

void Groups::add(std::uint32_t first, int group)
{
    if (runs.empty() ? group != none : runs.back().group != group) runs.push_back({first, group});
}

void Groups::assign(const std::vector<std::uint32_t>& ids, int group)
{
    std::map<std::uint32_t, int> from;  // the group of the ids from each one on
    for (const Run& r : runs) from[r.first] = r.group;
    for (std::size_t k = 0; k < ids.size();) {
        const std::uint32_t first = ids[k];
        std::uint32_t end = first;
        for (; k < ids.size() && ids[k] == end; ++k) ++end;
        const int after = of(end);
        from.erase(from.lower_bound(first), from.lower_bound(end));
        from[first] = group;
        from.emplace(end, after);
    }
    runs.clear();
    for (const auto& [first, number] : from) add(first, number);
}

int Groups::of(std::uint32_t id) const
{
    const auto after = std::upper_bound(runs.begin(), runs.end(), id,
                                        [](std::uint32_t i, const Run& r) { return i < r.first; });
    return after == runs.begin() ? none : std::prev(after)->group;
}

void Groups::transfer(io::Archive& a)
{
    a.list(runs);
    a.check_each(
        runs, "invalid group of particles",
        [&](const Run& r) { return r.group >= none && r.group < static_cast<int>(names.size()); },
        [](const Run& r) { return std::to_string(r.group) + " from id " + std::to_string(r.first); });
    a.check(std::is_sorted(runs.begin(), runs.end(),
                           [](const Run& x, const Run& y) { return x.first < y.first; }),
            "the ids of the groups must be in ascending order");
}

}  // namespace hilda::granular
