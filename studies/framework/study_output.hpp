// SPDX-License-Identifier: GPL-3.0-or-later
/// How a study ends: its tables on stdout, its files, its figures, its exit code.

#pragma once

#include "studies/framework/expectations.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/table.hpp"

#include <nlohmann/json.hpp>

#include <sstream>
#include <utility>

namespace hilda::studies {

struct StudyOutput {
    std::string kind = {};
    std::ostringstream text = {};                                    ///< for people
    std::string table = {};                                          ///< study.csv
    nlohmann::ordered_json json = nlohmann::ordered_json::object();  ///< what study.json says after its head
    std::vector<std::pair<std::string, std::string>> files = {};     ///< more tables: name and content
    std::vector<std::string> figures = {};                           ///< what KIND.py draws from the tables
};

/// Prints and writes; returns the exit code: 4 when all members failed, 6 when an expectation did not come
/// out. The head of study.json has the settings, the seed, the repeats and where the result comes from.
int finish(const StudyOptions& options, const StudyOutput& output,
           const std::vector<const Run*>& run_pointers, const std::vector<Measured>& measured);

/// Of numbers that may be none: null
nlohmann::ordered_json number_or_null(double value);

}  // namespace hilda::studies
