// SPDX-License-Identifier: GPL-3.0-or-later
/// Provenance of a run or a study: versions, build, command line and processor.

#pragma once

#include "io/json.hpp"

#include <string>
#include <utility>
#include <vector>

namespace hilda::studies {

/// Name and version of each library
std::vector<std::pair<std::string, std::string>> libraries();
/// Version, git state, compiler and flags, libraries, command line, processor and number of threads
io::Json provenance(const std::string& command_line, int threads);

}  // namespace hilda::studies
