// SPDX-License-Identifier: GPL-3.0-or-later
/// Figures. A Python script for each kind of result reads the CSV files of a directory and writes figures to
/// it, in one or more formats.

#pragma once

#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

/// Formats and contents of figures
struct FigureOptions {
    std::vector<std::string> formats = {};  ///< of figure_formats() in run/figures.hpp; empty: png
    std::vector<std::string> integrators =
        {};  ///< the curves to show; empty: the choice of the script, at most eight
    std::vector<std::string> quantities = {};  ///< the panels to show; empty: all that have values
};

/// Runs a script, for example "convergence.py", on a directory, and returns the names of the files that it
/// has written. Returns nothing after a one-line warning on stderr if Python, matplotlib or the script is
/// missing, or if the script fails or writes no figure. io::UsageError if the results do not have an
/// integrator or a quantity of the options.
///
/// The script has no time limit. SIGINT (Ctrl-C), SIGTERM and SIGHUP end it; their handlers are called then.
std::optional<std::vector<std::string>> plot(const std::string& script, const std::string& directory,
                                             const FigureOptions& options = {});

/// The same as a DrawFigures, see run/figures.hpp
std::vector<std::string> draw_figures(const std::string& script, const std::string& directory,
                                      const std::vector<std::string>& formats);

/// Replaces this program by a script, for example "view.py", which then has the terminal, and whose messages
/// and exit codes are those of the program. Throws io::NotAvailable if Python or the script is missing.
[[noreturn]] void start_script(const std::string& script, const std::vector<std::string>& arguments);

/// The last line of the output of a process
std::string last_line(std::string text);

/// Adds a directory in which plot() looks for scripts, after those of the program.
void add_script_directory(const std::string& directory);

/// The script for the results in a directory: trajectory.py for trajectory.csv, granular-run.py for run.csv,
/// fit.py for fit.csv, KIND.py for study.csv, where study.json states KIND. lie::InvalidInput if there is
/// none of these files.
std::string script_for(const std::string& directory);

/// Versions of Python and matplotlib, or the missing component; for hilda info
std::string python_and_matplotlib();

}  // namespace hilda::studies
