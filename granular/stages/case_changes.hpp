// SPDX-License-Identifier: GPL-3.0-or-later
/// The entries in which two cases differ, and those that may change during a run.

#pragma once

#include "io/json.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

/// An entry of a case that another case has with another value, or does not have
struct CaseChange {
    std::string pointer;
    const io::Json *was, *is;  ///< values in the two trees; nullptr: missing

    /// "POINTER was A and is B now"
    std::string text() const;
    /// Whether a run can continue with the new value: see changeable_entries
    bool is_possible() const;
};

/// The entries in which two trees differ, in the order of the first one. The trees outlive the result. Lists
/// of numbers and texts, and lists of different lengths, are compared as a whole.
std::vector<CaseChange> changes_of(const io::Json& before, const io::Json& now);

/// What a continued run may change, for messages
inline constexpr const char* changeable_entries =
    "a run can change name, note, gravity, end and interval; r, v, omega, F and T of boundaries; the numbers "
    "of "
    "laws; and rate, mass_rate, to, v, random_v and active of insertions";

}  // namespace hilda::granular
