// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda new: the starting point of a plug-in.

#pragma once

#include <string>

namespace hilda::studies {

/// Writes NAME/CMakeLists.txt and NAME/scheme.cpp: an integrator of second order as a plug-in (examples/plugin). Prints
/// the commands that build and evaluate it; returns the exit code.
///
/// `kind`: what is made, "integrator". `output`: the directory; "": NAME. io::UsageError for another kind, for a name with other
/// characters than letters, digits, - and _, for the name of a registered integrator, and for a directory that is not
/// empty.
int new_plugin(const std::string& kind, const std::string& name, const std::string& output);

}  // namespace hilda::studies
