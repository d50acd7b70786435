// SPDX-License-Identifier: GPL-3.0-or-later
/// The options of the commands study, fit, reproduce, plot and view.

#pragma once

#include "studies/program/fit_command.hpp"
#include "studies/program/plot.hpp"
#include "studies/program/repeating/reproduce.hpp"
#include "studies/program/study_option_table.hpp"
#include "studies/program/view.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace hilda::studies {

/// `kind` receives the name of the study, "" without one.
void add_study_options(CLI::App& command, std::string& kind, StudyArguments& to);
/// Removes the options that a study does not take, for its help, and adds its keys and files.
void restrict_help(CLI::App& command, const Study& to);

void add_fit_options(CLI::App& command, FitOptions& to);
void add_reproduce_options(CLI::App& command, ReproduceOptions& to);
void add_plot_options(CLI::App& command, std::string& directory, FigureOptions& figures);
void add_view_options(CLI::App& command, ViewOptions& to);

}  // namespace hilda::studies
