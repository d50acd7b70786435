// SPDX-License-Identifier: GPL-3.0-or-later
/// Expected results of a study (--expect).

#pragma once

#include "studies/framework/study.hpp"

#include <map>
#include <span>

namespace hilda::studies {

/// Results of one part of a study, by the keys of --expect
struct Measured {
    std::string of;  ///< for messages: "rA-half-1 on double_pendulum"
    std::map<std::string, double> value;
};

/// io::UsageError for a key that is not in `known`.
void check_keys(const std::string& kind, const StudyOptions& options, std::span<const std::string> known);

/// Compares all expectations with all measured values of their keys. Prints a line on stderr for each
/// difference above the tolerance and for each key that was not measured. Returns true if there is none.
bool as_expected(const std::vector<Expectation>& expectations, const std::vector<Measured>& measured);

}  // namespace hilda::studies
