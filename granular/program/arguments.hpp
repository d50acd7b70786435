// SPDX-License-Identifier: GPL-3.0-or-later
/// The command line of hilda-granular.

#pragma once

#include "granular/case/case_file.hpp"

namespace hilda::granular {

enum Exit {
    ok = 0,
    internal = 1,
    usage = 2,
    bad_case = 3,
    numerical = 4,
    io = 5,
    not_met = 6,
    no_device = 7,
    by_signal = 128
};

struct Options {
    std::string file, output, device_name = "cpu", command_line;
    Device device = {};
    double checkpoint = 0;  ///< [s] of the clock; 0: none
    int threads = 1;
    std::vector<Setting> settings;  ///< of the case
    std::optional<std::uint64_t> seed;
    std::string for_cases;  ///< the first option that was given and that validations have no use for
    bool full = false;      ///< of a validation
    bool quiet = false, verbose = false, json = false, force = false, resume = false, no_vtk = false;
};

/// Into `options`, or the exit code of a program that has said what there was to say
std::optional<int> read_arguments(int argc, char** argv, Options& options);

}  // namespace hilda::granular
