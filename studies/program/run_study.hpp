// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda study KIND: finds the study and creates its output directory.

#pragma once

#include "run/jobs/finished_jobs.hpp"
#include "studies/framework/study.hpp"

#include <string>

namespace hilda::studies {

/// The study with this name. io::UsageError with the nearest name if there is none.
const Study& find_study(const std::string& kind);
/// Whether a study takes an option of hilda study, such as --reference
bool takes_option(const Study& study, const std::string& option);

/// Runs the study `kind` and returns its exit code. The output directory is options.output, default out/KIND;
/// it must be new or empty unless options.force is set. With options.json and without options.output no files
/// are written. io::UsageError for an unknown study or for an option that the study does not use.
int run_study(const std::string& kind, StudyOptions options);

/// The same with the results of all runs, from shards: no run is computed.
int run_collected(const std::string& kind, StudyOptions options, const run::JobRecords& collected);

}  // namespace hilda::studies
