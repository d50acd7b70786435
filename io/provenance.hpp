// SPDX-License-Identifier: GPL-3.0-or-later
/// Provenance of a result: the part of a summary that may differ between two identical runs.

#pragma once

#include "io/json.hpp"

#include <string>
#include <utility>
#include <vector>

namespace hilda::io {

/// Model name of the processor; "unknown" if the system does not provide it
std::string processor();

/// Version and build of a program
struct Build {
    const char *number, *git, *build_type, *flags, *compiler;
};

/// Provenance of a result: version, build, libraries (name and version), command line, processor, threads
Json provenance(const Build& build, const std::vector<std::pair<std::string, std::string>>& libraries,
                const std::string& command_line, int threads);

/// Words of a command line, each quoted for a shell if it needs quotes
std::string shell_quoted(int argc, char** argv);

}  // namespace hilda::io
