// SPDX-License-Identifier: GPL-3.0-or-later
/// The run in an output directory, which --resume continues.

#pragma once

#include "granular/case/case_file.hpp"
#include "granular/running/run_options.hpp"
#include "granular/stages/continuation.hpp"

namespace hilda::granular {

/// The case of the run in a directory, from its case.json; empty if there is no such file. Throws
/// io::IoError, and io::InvalidInput if it is not valid JSON.
std::optional<io::JsonSource> earlier_case(const std::string& directory);

/// Reads a case for a new run, or with --resume for the continuation of that in the output directory. Throws
/// io::InvalidInput, io::IoError, DeviceError.
Continuation read_run(const RunOptions& options, const std::string& text, const Environment& environment);

struct EarlierRun {
    bool is_complete = false;  ///< it has reached its end
    long end = 0;              ///< [steps]; 0: there is no run in the directory
};

/// The run in the output directory, which the run of case c continues.
///
/// Throws io::UsageError if it has reached an end after that of c, or if it is complete and has no checkpoint
/// for a later end.
EarlierRun earlier_run(const RunOptions& options, const Case& c);

/// Throws io::UsageError: the end of c is not after the time [s] that the run in the output directory has
/// reached.
[[noreturn]] void refuse_end(const RunOptions& options, const Case& c, double reached);

/// Throws io::UsageError: the stages of the run in the output directory have ended at the time [s], so that
/// another end has no effect.
[[noreturn]] void refuse_end_after_stages(const RunOptions& options, double reached);

/// Reports that the run in the output directory is complete, with --json by its summary. Returns the exit
/// code. Throws io::IoError.
int report_complete(const RunOptions& options, const Case& c);

}  // namespace hilda::granular
