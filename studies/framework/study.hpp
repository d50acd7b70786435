// SPDX-License-Identifier: GPL-3.0-or-later
/// The list of registered studies.

#pragma once

#include "io/registry.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::studies {

class StudyContext;

/// Names of options of hilda study
using OptionNames = std::vector<std::string>;

/// --integrator, --steps, --end and `more`: the options of a study that simulates its own models
OptionNames options_of_integrators(const OptionNames& more = {});
/// The same and --problem: those of a study of any models
OptionNames options_of_models(const OptionNames& more = {});

/// A registered study
struct Study {
    std::string name;
    std::string answers;  ///< one line: figure or table of the dissertation, or question
    /// The options that it takes, of those that not every study has (study_option_table.hpp of the program).
    /// --integrator, --reference and --sweep bring others, such as the settings of the integrators.
    /// --repeats: it measures times, by default with one run at a time. --shard: it computes one pool of
    /// independent runs, and code after it runs once all results are there.
    OptionNames options = options_of_models();
    std::vector<std::string> keys = {};  ///< of --expect
    /// For the help: files beside study.csv and study.json. Words in capitals stand for names, as in
    /// energy-PROBLEM.png.
    std::vector<std::string> files = {};
    std::function<void(StudyContext&)> run = {};  ///< the experiment: fills the results of the context

    /// Whether `options` has the option with this name
    bool lists(const std::string& option) const;
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
