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

/// The files with their sizes and checksums (io::checksum), each once: [{"file": ..., "bytes": ...,
/// "checksum": ...}, ...]. A file that cannot be read any more has no checksum.
Json inputs(const std::vector<std::string>& files);
/// The checksum of a file as in inputs(); empty if it cannot be read
std::string checksum_of_file(const std::string& file);

/// Words of a command line, each quoted for a shell if it needs quotes
std::string shell_quoted(int argc, char** argv);

}  // namespace hilda::io
