// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies: what they are given, and the list of them.

#pragma once

#include "lie/integrator.hpp"

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
    std::optional<double> end;     ///< [s]
    std::vector<std::string> set;  ///< /json/pointer=VALUE
    lie::Settings settings;
    std::string output;  ///< directory, already made and empty; "" with --json and no --output
    int jobs = 1;        ///< runs side by side
    bool plot = true, quiet = false, json = false;
    std::vector<Expectation> expect;
    std::string command_line;  ///< for the record
};

struct Study {
    std::string kind;
    std::string answers;                        ///< the figure or table it answers, one line
    int (*run)(const StudyOptions&) = nullptr;  ///< returns the exit code; writes into output
};

const std::vector<Study>& studies();
bool enrol(Study study);

}  // namespace hilda::studies
