// SPDX-License-Identifier: GPL-3.0-or-later
/// Reading of the CSV tables of studies.

#pragma once

#include "tests/support/program/program.hpp"

#include <cmath>
#include <map>

namespace hilda::tests {

/// The fields of a row, by column name
using CsvRow = std::map<std::string, std::string>;

inline std::vector<std::string> fields(const std::string& line)
{
    std::vector<std::string> out(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            out.emplace_back();
        else
            out.back() += c;
    }
    return out;
}

/// The rows of a table whose fields contain no quotes and no line breaks; empty if the file does not exist
inline std::vector<CsvRow> csv(const fs::path& file)
{
    std::istringstream in(read(file));
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> names = fields(line);
    std::vector<CsvRow> rows;
    while (std::getline(in, line)) {
        const std::vector<std::string> values = fields(line);
        if (values.size() != names.size())
            throw std::runtime_error("a row has a different number of fields than the header: " + line);
        rows.emplace_back();
        for (size_t k = 0; k < names.size(); ++k) rows.back()[names[k]] = values[k];
    }
    return rows;
}

/// The number in a field, NaN for an empty field. std::out_of_range if there is no such column.
inline double number(const CsvRow& row, const std::string& column)
{
    const std::string& text = row.at(column);
    return text.empty() ? std::nan("") : std::strtod(text.c_str(), nullptr);
}

}  // namespace hilda::tests
