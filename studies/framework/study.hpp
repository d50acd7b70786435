// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies: what they are given, and the list of them.

#pragma once

#include "lie/integrator.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

/// --expect KEY=VALUE[+-TOL]: what must come out
struct Expectation {
    std::string key;
    double value = 0, tolerance = 0;
    std::string text;  ///< as typed
};

/// What the command line asks of a study. An empty list means: the study's own default.
struct StudyOptions {
    std::vector<std::string> problems;  ///< names or paths of model files
    std::vector<std::string> integrators;
    std::vector<double> steps;     ///< [s], descending
    std::vector<double> rtols;     ///< of adaptive integrators, descending
    std::vector<int> bars;         ///< of the chains of scaling, ascending
    std::optional<double> end;     ///< [s]
    std::vector<std::string> set;  ///< /json/pointer=VALUE
    lie::Settings settings;

    std::string reference;                                 ///< an integrator; "": the truth of each problem
    std::optional<double> reference_step, reference_rtol;  ///< [s], 1
    std::string preset;       ///< of the friction: balanced or dissertation; "": the default of the study
    std::string normal_rows;  ///< of contacts that are constraints: tangent or fixed-xy; "": tangent
    std::string against;      ///< a CSV file to compare with; "": none
    std::string grid;         ///< of a sweep, by a name that the study knows; "": its default

    int vtk = 0;      ///< frames of each run for ParaView; 0: none
    int repeats = 0;  ///< of what is timed; 0: the default of studies that time
    std::uint64_t seed = 0;

    std::string output;  ///< directory, already made and empty; "" with --json and no --output
    int jobs = 0;        ///< runs side by side; 0: one for each core, or one where time is measured
    bool check = false;  ///< all that must come out is wanted, and exit code 6 where it does not
    bool force = false;  ///< take a directory that is not empty, and a reference that is too coarse
    bool plot = true, quiet = false, json = false;
    std::vector<Expectation> expect;
    std::string command_line;  ///< for the record
};

/// Options that only some studies take
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
    normal_rows = 512
};
}  // namespace takes

struct Study {
    std::string kind;
    std::string answers;                               ///< the figure or table it answers, one line
    unsigned also = 0;                                 ///< of what is in takes
    std::function<int(const StudyOptions&)> run = {};  ///< returns the exit code; writes into output
};

const std::vector<Study>& studies();
bool register_study(Study study);
/// Studies that follow from another list: it is asked when studies() is, and not before all is enrolled that enrols itself.
bool register_studies(std::vector<Study> (*make)());

}  // namespace hilda::studies
