// SPDX-License-Identifier: GPL-3.0-or-later
/// Provenance of a run or a study: versions, build, command line and processor.

#pragma once

#include "io/json.hpp"

#include <string>
#include <utility>
#include <vector>

namespace hilda::run {

/// Name and version of each library
std::vector<std::pair<std::string, std::string>> libraries();
/// "hilda 0.1.0 (7734a36)": version and git state of the program
std::string version_line();
/// Build type, compiler and flags
std::string build_line();
/// The optional modules with their state: "HDF5, MPI, URDF; missing: MJCF"
std::string modules_line();
/// Version, git state, compiler and flags, libraries, command line, processor and number of threads
io::Json provenance(const std::string& command_line, int threads);

}  // namespace hilda::run
