// SPDX-License-Identifier: GPL-3.0-or-later
/// Provenance of a run: the part of the summary that may differ between two runs of the same case.

#pragma once

#include "io/json.hpp"

namespace hilda::granular {

/// "hilda-granular VERSION (git STATE, BUILD TYPE)"
std::string version_line();
/// Compiler, flags and devices
std::string build_line();

/// Version, build, libraries, command line, processor, threads and device
io::Json provenance(const std::string& command_line, int threads, const std::string& device);

}  // namespace hilda::granular
