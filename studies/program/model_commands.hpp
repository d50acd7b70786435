// SPDX-License-Identifier: GPL-3.0-or-later
/// The options of the commands for one model: run, kinematics and check.

#pragma once

#include "run/cosim/run_cosim.hpp"
#include "run/importing/export_urdf.hpp"
#include "run/importing/import_model.hpp"
#include "run/kinematics/kinematics.hpp"
#include "studies/program/check_model.hpp"
#include "studies/program/run_model.hpp"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

/// The arguments of hilda run
struct RunArguments {
    run::RunOptions options;
    std::vector<std::string> integrators;  ///< empty: that of RunOptions
    std::optional<double> every;           ///< value of --every, the old name of --interval
};

void add_run_options(CLI::App& command, RunArguments& to);
/// io::UsageError for options that exclude each other
run::RunOptions run_options(const RunArguments& arguments);

/// Adds the options of hilda cosim.
void add_cosim_options(CLI::App& command, run::CosimOptions& to);

void add_kinematics_options(CLI::App& command, run::KinematicsOptions& to);
/// hilda inverse
void add_inverse_options(CLI::App& command, run::KinematicsOptions& to);
void add_check_options(CLI::App& command, run::CheckOptions& to);

void add_import_options(CLI::App& command, run::ImportOptions& to);
void add_export_options(CLI::App& command, run::ExportOptions& to);

}  // namespace hilda::studies
