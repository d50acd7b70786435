// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/table.hpp"

#include "io/csv.hpp"
#include "io/json.hpp"

#include <fmt/format.h>

#include <ostream>

namespace hilda::studies {

namespace {

std::string for_people(const Table::Cell& cell, const std::string& format)
{
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    const double value = number(cell);
    return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

}  // namespace

void Table::add(std::vector<Cell> row)
{
    if (row.size() != columns.size()) throw std::logic_error("a row must have a cell for each column");
    cells.push_back(std::move(row));
}

void Table::print(std::ostream& out) const
{
    std::vector<size_t> width;
    for (size_t c = 0; c < columns.size(); ++c) {
        width.push_back(columns[c].name.size());
        for (const auto& row : cells)
            width[c] = std::max(width[c], for_people(row[c], columns[c].format).size());
    }
    for (size_t c = 0; c < columns.size(); ++c)
        out << fmt::format("{:>{}}", columns[c].name, width[c] + (c == 0 ? 0 : 2));
    out << '\n';
    for (const auto& row : cells) {
        for (size_t c = 0; c < columns.size(); ++c)
            out << fmt::format("{:>{}}", for_people(row[c], columns[c].format), width[c] + (c == 0 ? 0 : 2));
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
