// SPDX-License-Identifier: GPL-3.0-or-later
/// The end of a study: its text on the terminal, its files and figures, and its exit code.

#pragma once

#include "run/jobs/finished_jobs.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/program/study_option_table.hpp"

namespace hilda::studies {

/// Prints the text, writes the files and draws the figures. Returns the exit code: 4 if all runs failed (or
/// one, see StudyContext::every_run_must_succeed), 6 if an expectation or, with --check, a criterion failed.
/// The common keys of study.json are study, tolerance, settings, seed, set, provenance and, if
/// options.repeats > 0, repeats. `finished` is removed: nothing is left to resume.
int finish(const Study& study, const StudyContext& results, const StudyArguments& arguments,
           run::FinishedJobs* finished);
/// The end of one of several shards: its results are complete for hilda collect. Returns the exit code.
int finish_shard(const Study& study, const StudyArguments& arguments, run::FinishedJobs& finished);

}  // namespace hilda::studies
