// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda info: version, build and machine, for bug reports.

#pragma once

#include <string>

namespace hilda::studies {

/// Prints version, build, libraries, system and processor; returns the exit code.
int info(bool json, const std::string& command_line);

}  // namespace hilda::studies
