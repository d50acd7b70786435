// SPDX-License-Identifier: GPL-3.0-or-later
/// Repeats the command that has written a result directory, and compares the results.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

struct RerunOptions {
    std::string directory;                  ///< with summary.json, study.json or fit.json
    std::string output;                     ///< of the repetition, new or empty; empty: DIRECTORY-again
    double tolerance = 0;                   ///< see compare_results()
    std::vector<std::string> plugins = {};  ///< that are loaded, see load_plugin()
};

/// Words of a text that io::shell_quoted() has written. io::InvalidInput for an open quotation mark.
std::vector<std::string> shell_words(const std::string& text);

/// Repeats the recorded command with another output directory, in the present folder, and prints how the
/// files compare. Returns exit_code::expectation_failed if a file differs, else that of the command.
///
/// A record may come from elsewhere. Only commands that write a result are repeated, and only to the other
/// directory. A plug-in that the command loads is code: it must be loaded by this program as well.
///
/// Throws io::InvalidInput if the directory has no record of such a command, and io::UsageError for a plug-in
/// that is not loaded.
int rerun(const RerunOptions& options);

}  // namespace hilda::studies
