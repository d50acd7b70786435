// SPDX-License-Identifier: GPL-3.0-or-later
/// The settings on which the results of a run depend. A checkpoint contains them: a resumed run must have the
/// same.

#pragma once

#include <map>
#include <string>

namespace hilda::run {

/// Options by name, --step, with their values in the form of the command line; "" for a switch. `model` is
/// the checksum of the canonical text of the model.
using RunSettings = std::map<std::string, std::string>;

/// What differs, in one line: "it has --step 0.001, no --fix-initial; this run has --step 0.002,
/// --fix-initial". "" for equal settings. The difference of two models is the first one of their texts.
std::string difference(const RunSettings& earlier, const RunSettings& now, const std::string& earlier_model,
                       const std::string& model);

}  // namespace hilda::run
