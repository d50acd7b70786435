// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda new: the starting point of a plug-in.

#pragma once

#include <string>

namespace hilda::studies {

/// Writes the files of examples/plugin, an integrator of second order as a plug-in, or of
/// examples/plugin-granular-law, a hilda-granular with a normal law, with another name. Prints the commands
/// that build and evaluate it; returns the exit code.
///
/// `kind`: what is made, "integrator" or "granular-law". `output`: the directory; "": NAME. io::UsageError
/// for another kind, for a name with other characters than letters, digits, - and _, for the name of a
/// registered integrator, and for a directory that is not empty.
int new_plugin(const std::string& kind, const std::string& name, const std::string& output);

}  // namespace hilda::studies
