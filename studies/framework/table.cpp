// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/table.hpp"

#include "io/formats/csv.hpp"
#include "io/json.hpp"

#include <fmt/format.h>

#include <string_view>

namespace hilda::studies {

namespace {

std::string for_people(const Table::Cell& cell, const std::string& format)
{
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    const double value = number(cell);
    return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

/// The lines after the last empty line
std::string last_paragraph(std::string_view text)
{
    while (text.ends_with('\n')) text.remove_suffix(1);
    while (text.starts_with('\n')) text.remove_prefix(1);
    const size_t at = text.rfind("\n\n");
    return std::string(at == std::string_view::npos ? text : text.substr(at + 2));
}

}  // namespace

void Table::add(std::vector<Cell> row)
{
    if (row.size() != columns.size()) throw std::logic_error("a row must have a cell for each column");
    cells.push_back(std::move(row));
}

std::vector<std::vector<std::string>> Table::shown() const
{
    std::vector<std::vector<std::string>> rows(1);
    for (const Column& column : columns) rows.front().push_back(column.name);
    for (const auto& row : cells) {
        std::vector<std::string>& texts = rows.emplace_back();
        for (size_t c = 0; c < columns.size(); ++c) texts.push_back(for_people(row[c], columns[c].format));
    }
    return rows;
}

void Table::print(StudyText& out) const
{
    const std::vector<std::vector<std::string>> rows = shown();
    out.tables.push_back({last_paragraph(out.view()), rows});
    std::vector<size_t> width(columns.size());
    for (const auto& row : rows)
        for (size_t c = 0; c < columns.size(); ++c) width[c] = std::max(width[c], row[c].size());
    for (const auto& row : rows) {
        for (size_t c = 0; c < columns.size(); ++c)
            out << fmt::format("{:>{}}", row[c], width[c] + (c == 0 ? 0 : 2));
        out << '\n';
    }
}

std::string Table::csv() const
{
    std::string out;
    for (size_t c = 0; c < columns.size(); ++c) out += (c == 0 ? "" : ",") + io::csv_field(columns[c].name);
    out += '\n';
    for (const auto& row : cells) {
        for (size_t c = 0; c < columns.size(); ++c) {
            if (c > 0) out += ',';
            out += csv_text(row[c]);
        }
        out += '\n';
    }
    return out;
}

std::string csv_text(const Table::Cell& cell)
{
    if (const auto* text = std::get_if<std::string>(&cell)) return io::csv_field(*text);
    const double value = number(cell);
    return std::isnan(value) ? "" : io::shortest(value);
}

double number(const Table::Cell& cell)
{
    if (const auto* integer = std::get_if<long>(&cell)) return static_cast<double>(*integer);
    const auto* value = std::get_if<double>(&cell);
    return value != nullptr ? *value : std::nan("");
}

double fitted_order(const std::vector<double>& h, const std::vector<double>& e)
{
    const auto n = static_cast<double>(h.size());
    if (h.size() < 2) return std::nan("");
    double x_mean = 0, y_mean = 0;
    for (size_t k = 0; k < h.size(); ++k) x_mean += std::log(h[k]) / n, y_mean += std::log(e[k]) / n;
    double xx = 0, xy = 0;
    for (size_t k = 0; k < h.size(); ++k) {
        const double x = std::log(h[k]) - x_mean;
        xx += x * x;
        xy += x * (std::log(e[k]) - y_mean);
    }
    return xy / xx;
}

}  // namespace hilda::studies
