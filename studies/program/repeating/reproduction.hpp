// SPDX-License-Identifier: GPL-3.0-or-later
/// The figures of the dissertation as studies, and the page of their results: see reproduce.hpp.

#pragma once

#include "studies/framework/acceptance.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

/// A study that reproduces figures
struct Reproduction {
    std::string name;  ///< of its directory and of its section
    int chapter = 0;
    std::string figures;                ///< "Figs. 3.6, 3.7", "Fig. 4.18, Table 4.7"
    std::string title, shows;           ///< what the published figure shows
    std::string study;                  ///< its name and its arguments in both modes
    std::string quick = "", full = "";  ///< further arguments of --quick and --full
    std::string reduced = "";           ///< what --quick leaves out; "": nothing
    bool timed = false;                 ///< measures time: it runs alone

    /// The words of the command in one of the modes: hilda, study, its name, its arguments
    std::vector<std::string> words(bool of_full) const;
};

/// All entries, in the order of the dissertation
const std::vector<Reproduction>& reproductions();

/// A study of the list with its results
struct Reproduced {
    const Reproduction* entry = nullptr;
    std::string command = {};        ///< "hilda study energy --end 30"
    int exit_code = -1;              ///< of the study; -1: it has not ended
    double seconds = 0;              ///< wall time
    std::string status = "not run";  ///< passed, failed, done (no criterion), error, interrupted, not run
    std::vector<Criterion> criteria = {};
    std::vector<std::string> figures = {}, files = {};  ///< relative to the page
    std::string text = {}, message = {};                ///< its output, and the last line of its messages

    /// Whether the study has results, and is not run again by --resume
    bool has_ended() const { return status == "passed" || status == "failed" || status == "done"; }
};

/// Reads the results of a study that has ended with this exit code from DIRECTORY/NAME, DIRECTORY/NAME.txt
/// and DIRECTORY/NAME.log, and sets the status. io::IoError, io::InvalidInput.
void read_results(Reproduced& of, const std::string& directory);

/// The page index.html: no scripts, no files other than the figures and tables in its directory. `head`:
/// names and values of the table at its top. `quick`: each section states what --quick leaves out.
std::string page(const std::vector<Reproduced>& all,
                 const std::vector<std::pair<std::string, std::string>>& head, bool quick);

/// A text with the escapes of HTML
std::string html(const std::string& text);

}  // namespace hilda::studies
