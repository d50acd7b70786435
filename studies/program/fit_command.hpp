// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda fit: reads the data, fits the model, and writes the result.

#pragma once

#include "run/fitting/fit.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

struct FitOptions {
    std::string model, data;              ///< name or path; path of a CSV file
    std::vector<std::string> parameters;  ///< POINTER[=START[:LOW:HIGH[:SCALE]]]
    std::vector<std::string> columns;     ///< of the data; empty: all
    std::vector<std::string> sigma;       ///< VALUE for all columns, or COLUMN=VALUE
    std::vector<std::string> set;         ///< /json/pointer=VALUE
    std::string integrator = "rA-dop853";
    std::optional<double> step;  ///< [s]
    lie::Settings settings;
    std::vector<std::string> given_settings;  ///< options of `settings` that were given
    bool fix_initial = false;
    bool allow_paths = false;  ///< files that a file names need not be below its folder
    int max_fit_iterations = 100;
    int jobs = 0;  ///< 0: number of cores
    std::string output;
    bool force = false, plot = true, quiet = false, json = false;
    std::vector<std::string> figure_formats;
    std::string command_line;
};

/// A parameter of the command line. The start is that of the model if it is not stated. io::UsageError for
/// another form.
run::FitParameter fit_parameter(const std::string& text, const dae::Description& model);

/// Writes fit.json, fit.csv, model.json and fit.png to the output directory, prints the parameters with their
/// errors, and returns the exit code: 4 if the minimum was not reached. Exceptions as of fit().
int fit_model(const FitOptions& options);

}  // namespace hilda::studies
