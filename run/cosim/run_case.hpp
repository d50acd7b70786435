// SPDX-License-Identifier: GPL-3.0-or-later
/// A run of a granular case in this process, for studies.

#pragma once

#include <string>

namespace hilda::run {

/// Runs a case file to its end without output on the terminal. The results are written to the output
/// directory, which is replaced. Throws io::InvalidInput, io::IoError, and io::Failure with the exit code of
/// a run that does not come to its end.
void run_case(const std::string& file, const std::string& output);

}  // namespace hilda::run
