// SPDX-License-Identifier: GPL-3.0-or-later
/// Figures. A Python script for each kind of result reads the CSV files of a directory and writes PNG files
/// to it.

#pragma once

#include <string>

namespace hilda::studies {

/// Runs a script, for example "convergence.py", on a directory. Returns false after a one-line warning on
/// stderr if Python, matplotlib or the script is missing or if the script fails.
bool plot(const std::string& script, const std::string& directory);

/// Adds a directory in which plot() looks for scripts, after those of the program.
void add_script_directory(const std::string& directory);

/// The script for the results in a directory: trajectory.py for trajectory.csv, KIND.py for study.csv, where
/// study.json states KIND. lie::InvalidInput if there is neither file.
std::string script_for(const std::string& directory);

/// Versions of Python and matplotlib, or the missing component; for hilda info
std::string python_and_matplotlib();

}  // namespace hilda::studies
