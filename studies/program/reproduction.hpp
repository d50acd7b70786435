// SPDX-License-Identifier: GPL-3.0-or-later
/// The figures of the dissertation as studies: the list of `hilda reproduce`.

#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace hilda::studies {

/// Acceptance criterion on a column of study.csv: least <= value <= most for all selected rows
struct ReproductionCheck {
    std::string what;
    std::string column;
    /// Columns and the values that select rows; numbers are compared as numbers
    std::vector<std::pair<std::string, std::string>> where;
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    /// The value is divided by that of the row with this integrator and the same problem, h and bars; "": it
    /// is not
    std::string relative_to = "";
};

/// A study that reproduces figures
struct Reproduction {
    std::string name;  ///< of its directory and of its section
    int chapter = 0;
    std::vector<std::string> figures;  ///< "3.4", "Table 4.7"
    std::string title, shows;          ///< what the published figure shows
    std::string study;
    std::vector<std::string> arguments;              ///< of the study, in both modes
    std::vector<std::string> quick = {}, full = {};  ///< further arguments of --quick and --full
    std::string reduced = "";                        ///< what --quick leaves out; "": nothing
    std::string page;                                ///< in docs/results
    std::vector<ReproductionCheck> checks = {};      ///< besides those of the study (--check)
    bool timed = false;                              ///< measures time: it runs alone
};

/// All entries, in the order of the dissertation
const std::vector<Reproduction>& reproductions();

/// "Figs. 3.6, 3.7, 3.8", "Fig. 3.4", "Fig. 4.18, Table 4.7"
std::string names_of_figures(const Reproduction& entry);

}  // namespace hilda::studies
