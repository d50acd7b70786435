// SPDX-License-Identifier: GPL-3.0-or-later
/// The command line: what is typed becomes options, and options a call.

#pragma once

namespace hilda::studies {

/// Does what the command line says and returns the exit code. Throws UsageError for what it does not
/// understand.
int command_line(int argc, char** argv);

}  // namespace hilda::studies
