// SPDX-License-Identifier: GPL-3.0-or-later
/// The entries in which two cases differ, and those that may change during a run.

#pragma once

#include "io/json.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

/// Where an entry of a case changes
enum class ChangeIn {
    resumed_run,
    resumed_stages,  ///< a resumed run that has stages
    stage
};

/// An entry of a case that another case has with another value, or does not have
struct CaseChange {
    std::string pointer;
    const io::Json *was, *is;  ///< values in the two trees; nullptr: missing

    /// "POINTER was A and is B now"
    std::string text() const;
    /// Whether the run can continue with the new value: see changeable_entries()
    bool is_possible(ChangeIn where) const;
};

/// The entries in which two trees differ, in the order of the first one. The trees outlive the result. Lists
/// of numbers and texts, and lists of different lengths, are compared as a whole.
std::vector<CaseChange> changes_of(const io::Json& before, const io::Json& now);

/// The entries that can change, for messages: "a run can change name, note, ..."
std::string changeable_entries(ChangeIn where);

}  // namespace hilda::granular
