// SPDX-License-Identifier: GPL-3.0-or-later
/// The values of --sweep /json/pointer=VALUES.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

/// An entry of a model with the values that it takes in a sweep
struct SweptEntry {
    std::string pointer;              ///< /json/pointer
    std::vector<std::string> values;  ///< each as in --set /json/pointer=VALUE
};

/// Reads one --sweep. VALUES is a list of parts that are separated by commas outside of parentheses,
/// brackets and quotes:
///
///     VALUE           a JSON value, or a text without quotes, as in --set
///     A:B:N           N numbers from A to B with equal differences, N from 2 to 100000
///     A:B:N:log       N numbers from A to B with equal ratios; A and B have the same sign
///
/// io::UsageError for another form, for an empty part and for a value that occurs twice, as 10 and 1e1.
SweptEntry swept_entry(const std::string& text);

/// Reads all --sweep of a command. io::UsageError as above, for an entry that is given twice, and for more
/// than 100000 combinations.
std::vector<SweptEntry> swept_entries(const std::vector<std::string>& texts);

/// Combination number k of the values: the last entry changes fastest.
std::vector<std::string> combination(const std::vector<SweptEntry>& entries, std::size_t k);
/// Number of combinations
std::size_t combinations(const std::vector<SweptEntry>& entries);

}  // namespace hilda::studies
