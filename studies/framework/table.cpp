// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/table.hpp"

#include <fmt/format.h>

#include <charconv>
#include <ostream>

namespace hilda::studies {

namespace {

std::string for_people(const Table::Cell& cell, const char* format)
{
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    const double value = std::get<double>(cell);
    return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

std::string quoted(const std::string& text)
{
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + "\"";
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
    for (size_t c = 0; c < columns.size(); ++c) out += (c == 0 ? "" : ",") + quoted(columns[c].name);
    out += '\n';
    for (const auto& row : cells) {
        for (size_t c = 0; c < columns.size(); ++c) {
            if (c > 0) out += ',';
            const auto* text = std::get_if<std::string>(&row[c]);
            out += text != nullptr ? quoted(*text) : shortest(std::get<double>(row[c]));
        }
        out += '\n';
    }
    return out;
}

std::string shortest(double value)
{
    if (std::isnan(value)) return "";
    char buffer[32];
    const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, result.ptr};
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
