// SPDX-License-Identifier: GPL-3.0-or-later
/// Options of one simulation, as the commands hilda run and hilda cosim give them.

#pragma once

#include "io/sink.hpp"
#include "lie/settings.hpp"
#include "run/figures.hpp"
#include "run/watch/run_check.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::run {

class Coupling;

struct RunOptions {
    std::string model;  ///< name of a built-in model, or path of a model file
    std::vector<std::string> integrators{default_integrator};
    bool chooses_integrator = false;      ///< that of default_integrator_of() in the place of `integrators`
    std::optional<double> step;           ///< [s]; default: 1e-3
    std::optional<double> end, interval;  ///< [s]; defaults: end of the model, end/1000
    lie::Settings settings;
    std::vector<std::string> given_settings;  ///< the options of `settings` that were given, such as --rtol
    std::vector<std::string> set;             ///< /json/pointer=VALUE
    std::string normal_rows;  ///< of contact constraints: tangent or fixed-xy; "": the model's
    bool fix_initial = false;
    bool allow_paths = false;  ///< files that a file names need not be below its folder

    std::string output;  ///< directory; "": out/NAME
    bool force = false, resume = false;
    bool accept_step = false;  ///< run with a step above the stability limit of a force
    bool strict = false;       ///< end at the first warning about the solution, see Watch
    bool plot = false;
    bool error = false;                       ///< estimate the discretisation error
    std::vector<std::string> figure_formats;  ///< empty: png
    DrawFigures draw;                         ///< of --plot; empty: no figures
    io::SinkOptions outputs;                  ///< options of the output formats, such as --reactions
    double checkpoint = 0;                    ///< wall time between checkpoints [s]; 0: no checkpoints

    bool json = false, quiet = false, verbose = false;
    int threads = 1;
    std::string command_line;              ///< recorded in summary.json
    std::vector<std::string> inputs = {};  ///< files that were read besides those of the model
    std::vector<std::string> plugins;      ///< that are loaded, see load_plugin()
    Coupling* coupling = nullptr;          ///< of a co-simulation
};

}  // namespace hilda::run
