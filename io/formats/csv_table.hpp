// SPDX-License-Identifier: GPL-3.0-or-later
/// CSV tables of numbers from other sources, for comparison (--against FILE).

#pragma once

#include <string>
#include <vector>

namespace hilda::io {

/// A table with a header row of column names and rows of numbers. Lines that begin with # are comments.
struct CsvTable {
    std::string file;
    std::vector<std::string> columns;
    std::vector<std::vector<double>> rows;  ///< NaN for an empty field

    /// Index of a column. InvalidInput if there is no such column.
    size_t column(const std::string& name) const;
    /// All values of a column
    std::vector<double> values(const std::string& name) const;
};

/// Reads a table. InvalidInput with FILE:LINE for an invalid line, with FILE if the file cannot be read
/// or has no rows.
CsvTable read_csv_table(const std::string& file);

}  // namespace hilda::io
