// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda study KIND: finds the study and creates its output directory.

#pragma once

#include "run/jobs/finished_jobs.hpp"

#include <string>

namespace hilda::studies {

struct Study;
struct StudyArguments;

/// The study with this name. io::UsageError with the nearest name if there is none.
const Study& find_study(const std::string& kind);
/// Runs the study `kind` and returns its exit code. The output directory is that of --output,
/// default out/KIND; it must be new or empty without --force. With --json and without --output no files are
/// written. io::UsageError for an unknown study or for an option that the study does not use.
int run_study(const std::string& kind, StudyArguments arguments);

/// The same with the results of all runs, from shards: no run is computed.
int run_collected(const std::string& kind, StudyArguments arguments, const run::JobRecords& collected);

}  // namespace hilda::studies
