// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/csv_table.hpp"

#include "io/files.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace hilda::studies {

namespace {

constexpr size_t most = 256 << 20;  // bytes

std::string trimmed(const std::string& text)
{
    const size_t from = text.find_first_not_of(" \t\r"), to = text.find_last_not_of(" \t\r");
    return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

std::vector<std::string> fields(const std::string& line)
{
    std::vector<std::string> all;
    for (size_t from = 0; from <= line.size();) {
        const size_t to = std::min(line.find(',', from), line.size());
        all.push_back(trimmed(line.substr(from, to - from)));
        from = to + 1;
    }
    return all;
}

std::string contents(const std::string& file)
{
    try {
        return io::read_file(file, most);
    } catch (const io::IoError& error) {
        throw lie::InvalidInput(error.what());
    }
}

}  // namespace

size_t CsvTable::column(const std::string& name) const
{
    const auto at = std::find(columns.begin(), columns.end(), name);
    if (at == columns.end()) throw lie::InvalidInput(file + ": there is no column '" + name + "'");
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
    std::istringstream in(contents(file));
    std::string line;
    for (long n = 1; std::getline(in, line); ++n) {
        line = trimmed(line);
        if (line.empty() || line.starts_with('#')) continue;
        const auto refuse = [&](const std::string& what) {
            throw lie::InvalidInput(file + ":" + std::to_string(n) + ": " + what);
        };
        const std::vector<std::string> texts = fields(line);
        if (table.columns.empty()) {
            table.columns = texts;
            continue;
        }
        if (texts.size() != table.columns.size())
            refuse("a row must have a field for each of the " + std::to_string(table.columns.size()) +
                   " columns, got " + std::to_string(texts.size()));
        std::vector<double> row;
        for (const std::string& text : texts) {
            double value = std::nan("");
            const char* const end = text.data() + text.size();
            const auto [at, error] = std::from_chars(text.data(), end, value);
            if (!text.empty() && (error != std::errc() || at != end))
                refuse("must be a number, got '" + text + "'");
            row.push_back(value);
        }
        table.rows.push_back(std::move(row));
    }
    if (table.rows.empty()) throw lie::InvalidInput(file + ": has no rows of numbers");
    return table;
}

}  // namespace hilda::studies
