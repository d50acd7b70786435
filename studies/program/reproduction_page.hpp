// SPDX-License-Identifier: GPL-3.0-or-later
/// The results of `hilda reproduce`: read from the output directories of the studies, and written as one HTML
/// page.

#pragma once

#include "io/json.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/program/reproduction.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

/// A study of the list with its results
struct Reproduced {
    const Reproduction* entry = nullptr;
    std::string command;             ///< "hilda study energy --end 30"
    int exit_code = -1;              ///< of the study; -1: it has not ended
    double seconds = 0;              ///< wall time
    std::string status = "not run";  ///< passed, failed, done (no criterion), error, interrupted, not run
    std::vector<Criterion> criteria = {};
    std::vector<std::string> figures = {}, files = {};  ///< relative to the page
    std::string text = {}, message = {};                ///< its output, and the last line of its messages
};

/// Reads the results of a study that has ended with this exit code from DIRECTORY/NAME, DIRECTORY/NAME.txt
/// and DIRECTORY/NAME.log, evaluates the criteria, and sets the status. io::IoError.
void read_results(Reproduced& of, const std::string& directory);

/// Evaluates the criteria of the entry on the text of study.csv. `file` is for messages.
std::vector<Criterion> evaluate_checks(const Reproduction& entry, const std::string& csv,
                                       const std::string& file);

/// Whether a study has ended with results, and is not run again by --resume
bool has_ended(const Reproduced& of);

/// The contents of reproduce.json: the mode, the version of the program, and the studies that have ended.
/// `others`: those of other chapters.
io::Json record_of(const std::vector<Reproduced>& all, const io::Json::List& others, const std::string& mode);
/// Reads reproduce.json, and the results of those studies in `all` that have ended with the same command.
/// Returns the entries of other chapters. io::UsageError if the record has another mode or version;
/// io::InvalidInput.
io::Json::List read_record(const std::string& file, const std::string& directory, const std::string& mode,
                           std::vector<Reproduced>& all);

/// What the head of the page states
struct PageHead {
    std::string mode;  ///< quick or full
    std::string version, machine, date;
    double seconds = 0;  ///< wall time of the command
};

/// The page index.html: no scripts, no files other than the figures and tables in its directory
std::string page(const std::vector<Reproduced>& all, const PageHead& head);

/// A text with the escapes of HTML
std::string html(const std::string& text);

}  // namespace hilda::studies
