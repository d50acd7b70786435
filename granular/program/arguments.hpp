// SPDX-License-Identifier: GPL-3.0-or-later
/// The command line of hilda-granular.

#pragma once

#include "granular/case/case_file.hpp"
#include "io/sink.hpp"

namespace hilda::granular {

struct Options {
    std::string file, output, device_name = "cpu", command_line;
    std::string name, write_to;  ///< of the command cases: a built-in case, and where it is written
    Device device = {};
    io::SinkOptions outputs;  ///< options of the output formats, such as --no-vtk
    double checkpoint = 600;  ///< wall time between checkpoints [s]; 0: only after an interruption
    int threads = 1;
    std::vector<Setting> settings;  ///< changes of entries of the case
    std::optional<std::uint64_t> seed;
    std::string case_only_option;  ///< the first given option that is valid for cases only; empty if none
    bool full = false;             ///< full grid of a validation
    bool quiet = false, verbose = false, json = false, force = false, resume = false;
    bool strict = false;       ///< a warning of the watch ends the run
    bool allow_paths = false;  ///< the case may name files that are not below its folder
};

/// Reads the command line into `options`. Returns the exit code if the program must end: after --help,
/// --version or an error, which has been reported then.
std::optional<int> read_arguments(int argc, char** argv, Options& options);

}  // namespace hilda::granular
