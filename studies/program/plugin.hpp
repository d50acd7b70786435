// SPDX-License-Identifier: GPL-3.0-or-later
/// Plug-ins: shared libraries that register integrators, joints, forces, surfaces, laws, problems, studies or
/// output formats in the program.

#pragma once

#include <string>

namespace hilda::studies {

/// Loads a plug-in. Its static initialisers register its entries (io::Registry). Returns the path and the
/// checksum of the file, "/home/me/mine.so (0123456789abcdef)": the results of a run or a study depend on it.
///
/// io::NotAvailable for a file that cannot be read or is not a plug-in, for a plug-in of another version,
/// compiler or instruction set, for an undefined symbol, and for a plug-in that registers nothing. A plug-in
/// that throws while it is loaded ends the program with the exit code 7. Figures are drawn by scripts in the
/// folder of the plug-in as well.
std::string load_plugin(const std::string& file);

}  // namespace hilda::studies
