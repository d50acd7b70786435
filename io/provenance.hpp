// SPDX-License-Identifier: GPL-3.0-or-later
/// Parts of the provenance of a result that the programs have in common.

#pragma once

#include <string>

namespace hilda::io {

/// Model name of the processor; "unknown" if the system does not provide it
std::string processor();

/// Words of a command line, each quoted for a shell if it needs quotes
std::string shell_quoted(int argc, char** argv);

}  // namespace hilda::io
