// SPDX-License-Identifier: GPL-3.0-or-later
/// Fields and rows of CSV files.

#pragma once

#include <charconv>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::io {

/// Appends the shortest decimal text that reads back as the same double
inline void append_number(std::string& row, double value)
{
    char digits[32];
    row.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

inline void append_number(std::string& row, long value)
{
    char digits[32];
    row.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

/// Appends the components of a vector, each preceded by a comma
template <class Vector>
void append_vector(std::string& row, const Vector& v)
{
    for (int k = 0; k < v.size(); ++k) {
        row += ',';
        append_number(row, v[k]);
    }
}

/// A name as a field of the header row, quoted if it contains a comma, a quote or a line break, or if it
/// begins with a character that a spreadsheet takes for that of a formula
inline std::string csv_field(const std::string& name)
{
    const bool is_formula =
        !name.empty() && std::string_view("=+-@\t").find(name[0]) != std::string_view::npos;
    if (!is_formula && name.find_first_of(",\"\r\n") == std::string::npos) return name;
    std::string quoted = "\"";
    for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

/// A row of a table. The cells have no blanks at their ends.
struct CsvRow {
    const std::vector<std::string_view>& names;  ///< of the columns
    std::vector<std::string_view> cells;
    std::string place;  ///< FILE:LINE
};

/// Calls `use` for each row of a table. The first line has the names of the columns. Empty lines and lines
/// that begin with # are ignored. Throws InvalidInput with FILE:LINE for two columns of one name, for names
/// that semicolons or tabs separate, and for a row with another number of cells; with FILE for a text in
/// UTF-16.
void read_csv(std::string_view text, const std::string& file, const std::function<void(const CsvRow&)>& use);

}  // namespace hilda::io
