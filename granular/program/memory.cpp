// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace hilda::granular {

namespace {

constexpr auto unlimited = std::numeric_limits<std::size_t>::max();

/// The number after a word of a file, or at its beginning where the word is empty
std::optional<std::size_t> number_in(const std::string& file, const std::string& word = "")
{
    std::ifstream in(file);
    std::string at;
    while (!word.empty() && in >> at && at != word) {
    }
    std::size_t value = 0;
    if (in >> value) return value;
    return {};
}

/// What is left of a limit; pages of files that nobody uses go when they are needed.
std::size_t left(const std::string& limit, const std::string& usage, const std::string& stat,
                 const std::string& idle)
{
    const auto most = number_in(limit), used = number_in(usage);
    if (!most || !used) return unlimited;  // no such file, or "max" in it
    const std::size_t held = *used - std::min(*used, number_in(stat, idle).value_or(0));
    return *most - std::min(*most, held);
}

/// Of the control groups of this process and all above them, versions 1 and 2
std::size_t left_by_groups()
{
    std::size_t least = unlimited;
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string kind = line.substr(first + 1, second - first - 1);
        if (!kind.empty() && kind != "memory") continue;
        const std::string root = kind.empty() ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
        for (std::filesystem::path group = line.substr(second + 1);; group = group.parent_path()) {
            const std::string in = root + group.string() + '/';
            least = std::min(least, kind.empty()
                                        ? left(in + "memory.max", in + "memory.current", in + "memory.stat",
                                               "inactive_file")
                                        : left(in + "memory.limit_in_bytes", in + "memory.usage_in_bytes",
                                               in + "memory.stat", "total_inactive_file"));
            if (!group.has_relative_path()) break;
        }
    }
    return least;
}

}  // namespace

std::size_t available_memory()
{
    std::size_t least = left_by_groups();
    if (const auto free = number_in("/proc/meminfo", "MemAvailable:")) {
        least = std::min(least, 1024 * *free);
    } else if (const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
               pages > 0 && size > 0) {
        least = std::min(least, static_cast<std::size_t>(pages) * static_cast<std::size_t>(size));
    }
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
        const std::size_t used =
            number_in("/proc/self/statm").value_or(0) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        least = std::min(least, space.rlim_cur - std::min<std::size_t>(space.rlim_cur, used));
    }
    return least;
}

}  // namespace hilda::granular
