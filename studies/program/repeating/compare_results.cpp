// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/repeating/compare_results.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/option_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

namespace hilda::studies {

namespace fs = std::filesystem;

namespace {

struct Table {
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> rows;
};

Table read_table(const std::string& file)
{
    Table table;
    io::read_csv(io::read_file(file, size_t(2) << 30), file, [&](const io::CsvRow& row) {
        if (table.names.empty()) table.names.assign(row.names.begin(), row.names.end());
        table.rows.emplace_back(row.cells.begin(), row.cells.end());
    });
    return table;
}

bool is_computer_time(const std::string& name)
{
    // cpu_seconds, wall_ns and the like; columns of bodies have a dot.
    return name.find('.') == std::string::npos && (name.ends_with("seconds") || name.ends_with("wall_ns"));
}

/// The largest difference of two columns of numbers, divided by their largest value. Infinity for cells that
/// are not both numbers and differ.
double difference(const Table& a, const Table& b, size_t column, size_t& row)
{
    double largest = 0, value = 0;
    for (size_t n = 0; n < a.rows.size(); ++n) {
        const std::string &one = a.rows[n][column], &two = b.rows[n][column];
        const std::optional<double> x = io::number_in<double>(one), y = io::number_in<double>(two);
        if (x && std::isfinite(*x)) value = std::max(value, std::abs(*x));
        if (one == two) continue;
        const double d = x && y ? std::abs(*x - *y) : std::numeric_limits<double>::infinity();
        if (!(d <= largest)) largest = std::isnan(d) ? std::numeric_limits<double>::infinity() : d, row = n;
    }
    return largest > 0 && value > 0 ? largest / value : largest;
}

void compare_tables(const std::string& one, const std::string& two, double tolerance, FileComparison& result)
{
    const Table a = read_table(one), b = read_table(two);
    if (a.names != b.names || a.rows.size() != b.rows.size()) {
        result.is_equal = false;
        result.description = a.names != b.names
                                 ? "the columns differ"
                                 : fmt::format("{} rows, {} when repeated", a.rows.size(), b.rows.size());
        return;
    }
    double largest = 0;
    size_t at_column = 0, at_row = 0, left_out = 0;
    for (size_t c = 0; c < a.names.size(); ++c) {
        if (is_computer_time(a.names[c])) {
            ++left_out;
            continue;
        }
        size_t row = 0;
        const double d = difference(a, b, c, row);
        if (d > largest) largest = d, at_column = c, at_row = row;
    }
    result.is_equal = largest <= tolerance;
    result.description = largest == 0
                             ? fmt::format("{} rows, identical", a.rows.size())
                             : fmt::format(
                                   "{} rows, largest difference {:.1e} of the column {} in row {}: {}, {} "
                                   "when repeated",
                                   a.rows.size(), largest, a.names[at_column], at_row + 1,
                                   a.rows[at_row][at_column], b.rows[at_row][at_column]);
    if (left_out > 0) result.description += ", times of the computer left out";
}

/// The inputs and tables of a result, relative to its directory
std::set<std::string> files_of(const std::string& directory)
{
    std::set<std::string> files;
    std::error_code error;  // a link to itself is no file
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory)) {
        const std::string name = entry.path().filename();
        if (entry.is_regular_file(error) &&
            (name == "model.json" || name == "case.json" || entry.path().extension() == ".csv"))
            files.insert(entry.path().lexically_relative(directory));
    }
    return files;
}

}  // namespace

std::vector<FileComparison> compare_results(const std::string& one, const std::string& two, double tolerance)
{
    std::set<std::string> files = files_of(one);
    const std::set<std::string> of_one = files, of_two = files_of(two);
    files.insert(of_two.begin(), of_two.end());
    std::vector<FileComparison> all;
    for (const std::string& file : files) {
        FileComparison result{.file = file, .description = "identical"};
        const std::string first = fs::path(one) / file, second = fs::path(two) / file;
        if (!of_two.contains(file) || !of_one.contains(file)) {
            result.is_equal = false;
            result.description =
                of_one.contains(file) ? "is missing when repeated" : "exists only when repeated";
        } else if (io::read_file(first, size_t(2) << 30) != io::read_file(second, size_t(2) << 30)) {
            if (fs::path(file).extension() == ".csv") {
                compare_tables(first, second, tolerance, result);
            } else {
                result.is_equal = false;
                result.description = "differs: the input has changed";
            }
        }
        all.push_back(result);
    }
    return all;
}

}  // namespace hilda::studies
