// SPDX-License-Identifier: GPL-3.0-or-later
/// Plug-ins: shared libraries that register integrators, joints, forces, surfaces, laws, problems, studies or
/// output formats in the program.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

/// Loads a plug-in. Its static initialisers register its entries (io::Registry). Returns the path and the
/// checksum of the file, "/home/me/mine.so (0123456789abcdef)": the results of a run or a study depend on it.
///
/// io::NotAvailable for a file that cannot be read or is not a plug-in, for a plug-in of another version,
/// compiler or instruction set, for an undefined symbol, and for a plug-in that registers nothing. A plug-in
/// that throws while it is loaded ends the program with the exit code 7. Figures are drawn by scripts in the
/// folder of the plug-in as well.
std::string load_plugin(const std::string& file);

/// Loads the plug-ins of the options --load FILE before the command. Returns them as load_plugin(), and the
/// other words in `words`. The options of a command name registered integrators, so that these must exist
/// before the command line is read. io::UsageError for --load without a file.
std::vector<std::string> load_plugins(const std::vector<char*>& given, std::vector<char*>& words);

}  // namespace hilda::studies
