// SPDX-License-Identifier: GPL-3.0-or-later
/// Options of a run of a case.

#pragma once

#include "io/json.hpp"
#include "io/sink.hpp"

#include <string>

namespace hilda::granular {

struct RunOptions {
    std::string file = {}, output = {};  ///< name of the case in messages; output directory
    io::SinkOptions outputs = {};        ///< options of the output formats, such as --no-vtk
    double checkpoint = 600;             ///< wall time between checkpoints [s]; 0: only after an interruption
    bool quiet = false, verbose = false, json = false, force = false, resume = false;
    bool accept_step = false;  ///< run with a step above the stability limit
    bool strict = false;       ///< a warning of the watch ends the run
    io::Json provenance = {};  ///< of the program, for summary.json
};

}  // namespace hilda::granular
