// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies: their options and the list of registered studies.

#pragma once

#include "io/registry.hpp"
#include "lie/settings.hpp"
#include "run/figures.hpp"
#include "run/jobs/shard.hpp"

#include <cstdint>
#include <functional>
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

/// Options of a study. An empty list selects the default of the study.
struct StudyOptions {
    std::vector<std::string> problems;  ///< names or paths of model files
    std::vector<std::string> integrators;
    std::vector<double> steps;       ///< [s], descending
    std::vector<double> rtols;       ///< of adaptive integrators, descending
    std::vector<int> bars;           ///< numbers of bars of study scaling, ascending
    std::optional<double> end;       ///< [s]
    std::vector<std::string> set;    ///< /json/pointer=VALUE
    bool fix_initial = false;        ///< project inconsistent initial data onto the constraints
    std::vector<std::string> sweep;  ///< /json/pointer=VALUES of study sweep
    std::string observable;          ///< column of study sweep; "": that of the problem
    bool keep = false;               ///< keep the motion of each run of study sweep
    std::string format;              ///< of these motions: csv or hdf5; "": csv
    lie::Settings settings;
    std::vector<std::string> given_settings;  ///< the options of `settings` that were given, such as --rtol

    std::string reference;  ///< an integrator; "": the reference solution of each problem
    std::optional<double> reference_step, reference_rtol;  ///< [s], 1
    std::string preset;       ///< friction parameters: balanced or dissertation; "": the default of the study
    std::string normal_rows;  ///< of contact constraints: tangent or fixed-xy; "": tangent
    std::string against;      ///< a CSV file to compare with; "": none
    std::string grid;         ///< name of a parameter grid of a sweep; "": its default

    int vtk = 0;                        ///< frames of each run for ParaView; 0: none
    int repeats = 0;                    ///< of time measurements; 0: the default
    std::optional<std::uint64_t> seed;  ///< default: 0

    std::string output;  ///< existing output directory; "": no files (--json without --output)
    int jobs = 0;  ///< number of concurrent runs; 0: the number of cores, or 1 in a study that measures time
    bool strict = false;    ///< exit code 4 if the watch over a run has a warning
    bool check = false;     ///< evaluate all acceptance criteria; exit code 6 if one fails
    bool all = false;       ///< the complete default selection of a study that has a short one
    bool force = false;     ///< accept a non-empty directory and a reference solution that is too coarse
    bool resume = false;    ///< continue the interrupted study of the output directory
    run::Shard shard = {};  ///< the runs that are computed
    std::vector<std::string> arguments;  ///< of the command line, for hilda collect
    bool plot = true, quiet = false, json = false;
    std::vector<std::string> figure_formats;  ///< empty: png
    run::DrawFigures draw;                    ///< empty: no figures
    bool latex = false;                       ///< write study.tex
    std::vector<Expectation> expect;
    std::string command_line;          ///< recorded in study.json
    std::vector<std::string> plugins;  ///< that are loaded: path and checksum of each
};

/// Flags of the options that only some studies accept (Study::accepted)
namespace takes {
enum : unsigned {
    reference = 1,
    rtols = 2,
    repeats = 4,
    bars = 8,
    preset = 16,
    against = 32,
    grid = 64,
    check = 128,
    vtk = 256,
    normal_rows = 512,
    all = 1024,
    sweep = 2048,
    rtol = 4096,
    seed = 8192,
    strict = 16384,
    /// One pool of independent runs: --shard. Code after it runs once all results are there.
    shard = 32768
};
}  // namespace takes

/// Flags of the common options that a study does not have (Study::lacking)
namespace lacks {
enum : unsigned {
    problem = 1,
    models = 2,  ///< --integrator, --set and the options of lie::Settings
    steps = 4,
    end = 8,
    all = 15
};
}  // namespace lacks

class StudyContext;

/// A registered study
struct Study {
    std::string name;
    std::string answers;                 ///< one line: figure or table of the dissertation, or question
    unsigned accepted = 0;               ///< flags of `takes`
    unsigned lacking = 0;                ///< flags of `lacks`
    std::vector<std::string> keys = {};  ///< keys of --expect
    /// For the help: files beside study.csv and study.json. Words in capitals stand for names, as in
    /// energy-PROBLEM.png.
    std::vector<std::string> files = {};
    std::function<void(StudyContext&)> run = {};  ///< the experiment: fills the results of the context
};

}  // namespace hilda::studies

extern template class hilda::io::Registry<hilda::studies::Study>;

namespace hilda::studies {

/// All registered studies, sorted by name. A file adds one by io::Registry<Study>::add.
const std::vector<Study>& studies();
/// Adds a function that makes studies from another registry. It is called by the first call of studies(),
/// when all static initialisers have run.
bool register_studies(std::vector<Study> (*make)());

}  // namespace hilda::studies
