// SPDX-License-Identifier: GPL-3.0-or-later
/// The commands hilda kinematics and hilda inverse: the motion of a mechanism without degrees of freedom, and
/// the loads of its drivers.

#pragma once

#include "io/sink.hpp"
#include "run/figures.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::run {

struct KinematicsOptions {
    std::string model;                    ///< name of a built-in model, or path of a model file
    std::optional<double> end, interval;  ///< [s]; defaults: end of the model, end/1000
    std::vector<std::string> set;         ///< /json/pointer=VALUE
    bool fix_initial = false;
    bool allow_paths = false;  ///< files that a file names need not be below its folder

    std::string output;  ///< directory; "": out/NAME
    bool force = false;
    io::SinkOptions outputs;  ///< options of the output formats, such as --reactions

    bool inverse = false;  ///< hilda inverse: the table drives and its figure as well
    std::string motion;    ///< CSV file with the motions of joints and drivers; "": those of the model
    bool plot = true;
    std::vector<std::string> figure_formats;
    DrawFigures draw;  ///< empty: no figures

    bool json = false, quiet = false;
    std::string command_line;  ///< recorded in summary.json
};

/// Kinematic analysis (dae::Kinematics): positions, velocities, accelerations and multipliers at each output
/// row, from the constraints and drivers alone. The multipliers are the solution of the inverse dynamics: the
/// loads of joints and drivers that produce the motion. Writes the files of `hilda run`; hilda inverse also
/// the table drives (DriveColumns). lie::InvalidInput for a model with degrees of freedom, and of hilda
/// inverse without a driver; a lie::NumericalFailure ends the analysis with its status and exit
/// code 4.
int run_kinematics(const KinematicsOptions& options);

}  // namespace hilda::run
