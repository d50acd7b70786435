// SPDX-License-Identifier: GPL-3.0-or-later
/// The run in an output directory, which --resume continues.

#pragma once

#include "granular/program/arguments.hpp"

namespace hilda::granular {

/// The case of the run in a directory, from its case.json; empty if there is no such file. Throws
/// io::IoError, and io::InvalidInput if it is not valid JSON.
std::optional<io::JsonSource> earlier_case(const std::string& directory);

struct EarlierRun {
    bool is_complete = false;  ///< it has reached its end
    long end = 0;              ///< [steps]; 0: there is no run in the directory
};

/// The run in the output directory, which the run of case c continues.
///
/// Throws io::UsageError if it has reached an end after that of c, or if it is complete and has no checkpoint
/// for a later end.
EarlierRun earlier_run(const Options& options, const Case& c);

/// Throws io::UsageError: the end of c is not after the time [s] that the run in the output directory has
/// reached.
[[noreturn]] void refuse_end(const Options& options, const Case& c, double reached);

/// Throws io::UsageError: the stages of the run in the output directory have ended at the time [s], so that
/// another end has no effect.
[[noreturn]] void refuse_end_after_stages(const Options& options, double reached);

/// Reports that the run in the output directory is complete, with --json by its summary. Returns the exit
/// code. Throws io::IoError.
int report_complete(const Options& options, const Case& c);

}  // namespace hilda::granular
