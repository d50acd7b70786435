// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of the files of two result directories.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

/// How one file of two directories compares
struct FileComparison {
    std::string file;         ///< relative to the directories
    bool is_equal = true;     ///< within the tolerance
    std::string description;  ///< "identical", or what differs
};

/// Compares model.json, case.json and the tables (*.csv) of two directories and their subdirectories. Two
/// numbers of a table are equal if they differ by at most `tolerance` times the largest number of their
/// column. Columns with times of the computer (names that end with `seconds` or `wall_ns`) are left out.
/// io::IoError for files that cannot be read.
std::vector<FileComparison> compare_results(const std::string& one, const std::string& two, double tolerance);

}  // namespace hilda::studies
