// SPDX-License-Identifier: GPL-3.0-or-later
/// Tables of numbers that others wrote, to compare with: --against FILE.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

/// A header row with the names of the columns, then rows of numbers. Lines that begin with # are comments.
struct CsvTable {
    std::string file;
    std::vector<std::string> columns;
    std::vector<std::vector<double>> rows;  ///< NaN for an empty field

    /// The place of a column. InvalidInput names one that is not there.
    size_t column(const std::string& name) const;
    /// All of its numbers
    std::vector<double> values(const std::string& name) const;
};

/// InvalidInput FILE:LINE for what is not such a table, FILE for what cannot be read.
CsvTable read_csv_table(const std::string& file);

}  // namespace hilda::studies
