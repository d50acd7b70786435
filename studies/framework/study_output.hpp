// SPDX-License-Identifier: GPL-3.0-or-later
/// Output of a study: tables on stdout, files, figures and exit code.

#pragma once

#include "io/json.hpp"
#include "studies/framework/expectations.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/table.hpp"

#include <sstream>
#include <utility>

namespace hilda::studies {

struct StudyOutput {
    std::string kind = {};
    std::ostringstream text = {};        ///< text for stdout
    std::string table = {};              ///< contents of study.csv
    io::Json json = io::Json::object();  ///< contents of study.json after the common keys
    std::vector<std::pair<std::string, std::string>> files = {};  ///< further files: name and contents
    std::vector<std::string> figures = {};                        ///< files that plots/KIND.py draws
};

/// Prints the text, writes the files and draws the figures. Returns the exit code: 4 if all runs failed, 6 if
/// an expectation failed. The common keys of study.json are study, tolerance, settings, seed, set, provenance
/// and, if options.repeats > 0, repeats.
int finish(const StudyOptions& options, const StudyOutput& output,
           const std::vector<const Run*>& run_pointers, const std::vector<Measured>& measured);

}  // namespace hilda::studies
