// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda info: what a bug report needs.

#pragma once

#include <string>

namespace hilda::studies {

/// The program's name, version and git state, in one line
std::string version_line();

int info(bool json, const std::string& command_line);

}  // namespace hilda::studies
