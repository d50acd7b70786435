// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda kinematics: motion and driver loads of a mechanism without degrees of freedom.

#pragma once

#include "io/sink.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

struct KinematicsOptions {
    std::string model;                    ///< name of a built-in model, or path of a model file
    std::optional<double> end, interval;  ///< [s]; defaults: end of the model, end/1000
    std::vector<std::string> set;         ///< /json/pointer=VALUE
    bool fix_initial = false;

    std::string output;  ///< directory; "": out/NAME
    bool force = false;
    io::SinkOptions outputs;  ///< options of the output formats, such as --reactions

    bool json = false, quiet = false;
    std::string command_line;  ///< recorded in summary.json
};

/// Kinematic analysis (dae::Kinematics): positions, velocities, accelerations and multipliers at each output
/// row, from the constraints and drivers alone. The multipliers are the solution of the inverse dynamics: the
/// loads of joints and drivers that produce the motion. Writes the files of `hilda run`. lie::InvalidInput
/// for a model with degrees of freedom; a lie::NumericalFailure ends the analysis with its status and exit
/// code 4.
int run_kinematics(const KinematicsOptions& options);

}  // namespace hilda::studies
