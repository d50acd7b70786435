// SPDX-License-Identifier: GPL-3.0-or-later
/// The cases that are compiled into the program: the files in granular/cases.

#pragma once

#include <string>
#include <vector>

namespace hilda::granular {

struct BuiltInCase {
    std::string name;  ///< of the file, without .json
    std::string text;
    std::string note;  ///< the key `note`
};

/// All built-in cases, ordered by name
const std::vector<BuiltInCase>& built_in_cases();

/// The built-in case with this name; nullptr if there is none
const BuiltInCase* find_built_in_case(const std::string& name);

}  // namespace hilda::granular
