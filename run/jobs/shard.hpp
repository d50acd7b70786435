// SPDX-License-Identifier: GPL-3.0-or-later
/// Parts of a study: --shard I/N.

#pragma once

#include <fmt/format.h>

#include <string>

namespace hilda::run {

/// Part I of N of the jobs of a study: those with the numbers I - 1, I - 1 + N, I - 1 + 2 N, ...
struct Shard {
    long index = 1, count = 1;

    bool is_part() const { return count > 1; }
    bool has(long job) const { return job % count == index - 1; }
    /// "I/N"
    std::string text() const { return fmt::format("{}/{}", index, count); }
};

/// Thrown at the end of the jobs of a process that has only a part of them: the study cannot be evaluated
/// there.
struct PartDone {};

}  // namespace hilda::run
