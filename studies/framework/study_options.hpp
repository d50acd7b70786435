// SPDX-License-Identifier: GPL-3.0-or-later
/// The options of a study that its experiment and the framework read. The program has their table
/// (studies/program/study_option_table.hpp).

#pragma once

#include "lie/settings.hpp"
#include "run/jobs/shard.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

/// Expected value of a result: --expect KEY=VALUE[+-TOL]
struct Expectation {
    std::string key;
    double value = 0, tolerance = 0;
    std::string text;  ///< text of the command line
};

/// An empty list selects the default of the study.
struct StudyOptions {
    std::vector<std::string> given;     ///< names of the options that were given
    std::vector<std::string> problems;  ///< names or paths of model files
    std::vector<std::string> integrators;
    std::vector<double> steps;       ///< [s], descending
    std::vector<double> rtols;       ///< of adaptive integrators, descending
    std::vector<int> bars;           ///< numbers of bars of study scaling, ascending
    std::optional<double> end;       ///< [s]
    std::vector<std::string> set;    ///< /json/pointer=VALUE
    bool allow_paths = false;        ///< files that a file names need not be below its folder
    bool fix_initial = false;        ///< project inconsistent initial data onto the constraints
    std::vector<std::string> sweep;  ///< /json/pointer=VALUES of study sweep
    std::string observable;          ///< column of study sweep; "": that of the problem
    bool keep = false;               ///< keep the motion of each run of study sweep
    std::string format;              ///< of these motions: csv or hdf5; "": csv
    lie::Settings settings;

    std::string reference;  ///< an integrator; "": the reference solution of each problem
    std::optional<double> reference_step, reference_rtol;  ///< [s], 1
    std::string preset;       ///< friction parameters: balanced or dissertation; "": the default of the study
    std::string normal_rows;  ///< of contact constraints: tangent or fixed-xy; "": tangent
    std::string against;      ///< a CSV file to compare with; "": none
    std::string grid;         ///< name of a parameter grid of a sweep; "": its default

    int vtk = 0;             ///< frames of each run for ParaView; 0: none
    int repeats = 0;         ///< of time measurements; 0: the default
    std::uint64_t seed = 0;  ///< of random initial velocities

    std::string output;  ///< existing output directory; "": no files (--json without --output)
    int jobs = 0;  ///< number of concurrent runs; 0: the number of cores, or 1 in a study that measures time
    bool strict = false;            ///< exit code 4 if the watch over a run has a warning
    bool check = false;             ///< evaluate all acceptance criteria; exit code 6 if one fails
    bool all = false;               ///< the complete default selection of a study that has a short one
    bool force = false;             ///< accept a non-empty directory
    bool accept_reference = false;  ///< accept a reference solution that is too coarse or unstable
    bool resume = false;            ///< continue the interrupted study of the output directory
    bool quiet = false;             ///< print no result, no warnings and no progress
    run::Shard shard = {};          ///< the runs that are computed
    std::vector<Expectation> expect;
};

}  // namespace hilda::studies
