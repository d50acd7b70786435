// SPDX-License-Identifier: GPL-3.0-or-later
/// --expect: what must come out of a study.

#pragma once

#include "studies/framework/study.hpp"

#include <map>
#include <span>

namespace hilda::studies {

/// What one part of a study came to, by the keys that --expect knows
struct Measured {
    std::string of;  ///< for messages: "rA-half-1 on double_pendulum"
    std::map<std::string, double> value;
};

/// UsageError for a key that the study does not know.
void check_keys(const std::string& kind, const StudyOptions& options, std::span<const std::string> known);

/// Names what was expected and did not come, one line each; true when all came, wherever the key is measured.
bool as_expected(const std::vector<Expectation>& expectations, const std::vector<Measured>& measured);

}  // namespace hilda::studies
