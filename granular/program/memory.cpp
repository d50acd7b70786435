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

/// The number that follows a word in a file, or the number at the beginning of the file if the word is empty
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

/// Limit minus usage, where inactive pages of the file cache do not count as used, since the kernel reclaims
/// them
std::size_t remaining(const std::string& limit, const std::string& usage, const std::string& stat,
                      const std::string& inactive)
{
    const auto limit_bytes = number_in(limit), used_bytes = number_in(usage);
    if (!limit_bytes || !used_bytes) return unlimited;  // the file does not exist, or contains "max"
    const std::size_t active_bytes =
        *used_bytes - std::min(*used_bytes, number_in(stat, inactive).value_or(0));
    return *limit_bytes - std::min(*limit_bytes, active_bytes);
}

/// Smallest remaining memory of the control groups (versions 1 and 2) of this process and of their parents
/// [bytes]
std::size_t remaining_in_control_groups()
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
            least = std::min(
                least, kind.empty() ? remaining(in + "memory.max", in + "memory.current", in + "memory.stat",
                                                "inactive_file")
                                    : remaining(in + "memory.limit_in_bytes", in + "memory.usage_in_bytes",
                                                in + "memory.stat", "total_inactive_file"));
            if (!group.has_relative_path()) break;
        }
    }
    return least;
}

}  // namespace

std::size_t available_memory()
{
    std::size_t least = remaining_in_control_groups();
    if (const auto free = number_in("/proc/meminfo", "MemAvailable:")) {
        least = std::min(least, 1024 * *free);
    } else if (const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
               pages > 0 && size > 0) {
        least = std::min(least, static_cast<std::size_t>(pages) * static_cast<std::size_t>(size));
    }
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
        const std::size_t used_bytes =
            number_in("/proc/self/statm").value_or(0) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        least = std::min(least, space.rlim_cur - std::min<std::size_t>(space.rlim_cur, used_bytes));
    }
    return least;
}

}  // namespace hilda::granular
