// SPDX-License-Identifier: GPL-3.0-or-later
/// The options of hilda study in one table. The command line, the help of each study, the options that a
/// study refuses, and the identity of its jobs come from it.

#pragma once

#include "io/option_values.hpp"
#include "run/figures.hpp"
#include "run/jobs/finished_jobs.hpp"
#include "studies/framework/study_options.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::studies {

struct Study;

/// The arguments of hilda study: the options of the study, and those that the program alone reads
struct StudyArguments {
    StudyOptions options;
    bool plot = true, json = false;
    bool latex = false;                       ///< write study.tex
    std::vector<std::string> figure_formats;  ///< empty: png
    run::DrawFigures draw;                    ///< empty: no figures
    std::string command_line;                 ///< recorded in study.json
    std::vector<std::string> words;           ///< of the command line, for hilda collect
    std::vector<std::string> plugins;         ///< that are loaded: path and checksum of each
};

struct StudyOption : io::Option {
    std::string with;         ///< name of the option that a study lists to have this one; "": all have it
    bool repeatable = false;  ///< it may be given several times
    std::function<void(StudyArguments& to, const std::string& option, const std::string& text)> read;
    /// The value in the identity of the jobs; only of options with Scope::numerical, which here includes what
    /// jobs write
    std::function<std::string(const StudyOptions& options)> identity = {};

    bool is_of(const Study& study) const;
};

/// All options, with the settings of the integrators, in the order of the help
std::vector<StudyOption> study_options();

/// io::UsageError for an option that was given and that the study does not have; the message names the
/// studies that have it.
void refuse_options_of_others(const Study& study, const StudyOptions& options);

/// All on which the results of the jobs of a study depend, with the contents of its model files
run::FinishedJobs::Identity identity_of_jobs(const Study& study, const StudyArguments& arguments);

}  // namespace hilda::studies
