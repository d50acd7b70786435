// SPDX-License-Identifier: GPL-3.0-or-later
/// The command line of the program hilda: reads the options of a command and executes it.

#pragma once

#include <functional>

namespace hilda::studies {

/// Reads a command line without --load, and returns the action of its command, which returns the exit code.
/// io::UsageError for an invalid command line.
std::function<int()> read_command_line(int argc, char** argv);

/// Executes the command of the command line and returns the exit code. io::UsageError for an invalid command
/// line.
int command_line(int argc, char** argv);

}  // namespace hilda::studies
