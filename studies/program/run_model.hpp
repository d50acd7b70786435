// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda run: one model, by one integrator after the other.

#pragma once

#include "lie/integrator.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

struct RunOptions {
    std::string model;  ///< a built-in name or a path
    std::vector<std::string> integrators{"rA-half-1"};
    std::optional<double> step;           ///< [s]; 1e-3
    std::optional<double> end, interval;  ///< [s]; the model's end, a thousandth of the end
    lie::Settings settings;
    std::vector<std::string> set;  ///< /json/pointer=VALUE
    std::string
        normal_rows;  ///< of contacts that are constraints: tangent or fixed-xy; "": as the model has it
    bool fix_initial = false;

    std::string output;  ///< "": out/NAME
    bool force = false, resume = false;
    bool reactions = false, log_steps = false, plot = false;
    std::optional<double> vtk;  ///< [s] between frames for ParaView
    double checkpoint = 0;      ///< wall seconds between checkpoints; 0: none

    bool json = false, quiet = false, verbose = false;
    int threads = 1;
    std::string command_line;  ///< for the record
};

/// Runs, writes, prints; returns the exit code: that of the first run that did not end well.
int run_model(const RunOptions& options);

}  // namespace hilda::studies
