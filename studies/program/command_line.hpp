// SPDX-License-Identifier: GPL-3.0-or-later
/// The command line of the program hilda: reads the options of a command and executes it.

#pragma once

namespace hilda::studies {

/// Executes the command of the command line and returns the exit code. io::UsageError for an invalid command
/// line.
int command_line(int argc, char** argv);

}  // namespace hilda::studies
