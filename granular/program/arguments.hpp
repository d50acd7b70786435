// SPDX-License-Identifier: GPL-3.0-or-later
/// The command line of hilda-granular.

#pragma once

#include "granular/case/case_file.hpp"
#include "granular/running/run_options.hpp"

namespace hilda::granular {

struct Options {
    RunOptions run = {};
    std::string device_name = "cpu", command_line;
    std::string name;      ///< after the commands cases and export: a case
    std::string write_to;  ///< of the command cases: where the case is written
    bool lammps = false;   ///< of the command export: the format
    Device device = {};
    int threads = 1;
    std::vector<Setting> settings;  ///< changes of entries of the case
    std::optional<std::uint64_t> seed;
    std::string case_only_option;  ///< the first given option that is valid for cases only; empty if none
    bool full = false;             ///< full grid of a validation
    bool exchanges = false;        ///< the grains of a co-simulation
    bool allow_paths = false;      ///< the case may name files that are not below its folder
};

/// Reads the command line into `options`. Returns the exit code if the program must end: after --help,
/// --version or an error, which has been reported then.
std::optional<int> read_arguments(int argc, char** argv, Options& options);

}  // namespace hilda::granular
