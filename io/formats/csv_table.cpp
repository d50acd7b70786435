// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/csv_table.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/option_values.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hilda::io {

namespace {

constexpr size_t most = 256 << 20;  // bytes

std::string contents(const std::string& file)
{
    try {
        return read_file(file, most);
    } catch (const IoError& error) {
        throw InvalidInput(error.what());
    }
}

}  // namespace

size_t CsvTable::column(const std::string& name) const
{
    const auto at = std::find(columns.begin(), columns.end(), name);
    if (at == columns.end()) throw InvalidInput(file + ": there is no column '" + name + "'");
    return static_cast<size_t>(at - columns.begin());
}

std::vector<double> CsvTable::values(const std::string& name) const
{
    const size_t c = column(name);
    std::vector<double> all;
    for (const auto& row : rows) all.push_back(row[c]);
    return all;
}

CsvTable read_csv_table(const std::string& file)
{
    CsvTable table{.file = file, .columns = {}, .rows = {}};
    read_csv(contents(file), file, [&](const CsvRow& row) {
        table.columns.assign(row.names.begin(), row.names.end());
        std::vector<double>& values = table.rows.emplace_back();
        for (size_t k = 0; k < row.cells.size(); ++k) {
            const std::string_view cell = row.cells[k];
            const auto value = cell.empty() ? std::optional(std::nan("")) : number_in<double>(cell);
            if (!value)
                throw InvalidInput(row.place + ": " + table.columns[k] + " must be a number, got '" +
                                   std::string(cell) + "'");
            values.push_back(*value);
        }
    });
    if (table.rows.empty()) throw InvalidInput(file + ": has no rows of numbers");
    return table;
}

}  // namespace hilda::io
