// SPDX-License-Identifier: GPL-3.0-or-later
/// Figures: a Python script per figure, which reads only the CSV files in a directory and writes PNG files
/// there.

#pragma once

#include <string>

namespace hilda::studies {

/// Runs the script (a name such as "convergence.py") on a directory. Where Python, matplotlib or the script
/// is missing, or the script fails, it says so on stderr in one line and returns false.
bool plot(const std::string& script, const std::string& directory);

/// The script for what lies in a directory: trajectory.csv, or study.csv and study.json. lie::InvalidInput
/// when there is neither.
std::string script_for(const std::string& directory);

/// What draws the figures, for `hilda info`: the Python and its matplotlib, or what is missing.
std::string python_and_matplotlib();

}  // namespace hilda::studies
