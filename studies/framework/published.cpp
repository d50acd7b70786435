// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/published.hpp"

#include "io/formats/csv_table.hpp"
#include "lie/check.hpp"
#include "studies/framework/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace hilda::studies {

namespace {

/// A column of the file and a curve with the same quantity: their largest difference, the time t [s] at which
/// it occurs, and the largest value of the column
struct ColumnMatch {
    std::string column, experiment, run;
    double largest = INFINITY, t = 0, size = 0;
    long shift = 0, rows = 0;
    double sign = 1;
    bool nearest = false;  ///< this run has the smallest difference of all runs with this quantity

    double relative() const { return size > 0 ? largest / size : largest; }
};

/// Compares rows of equal t for a file that is `shift` rows late and has this sign.
ColumnMatch difference(ColumnMatch d, const std::vector<double>& t, const std::vector<double>& reference,
                       const Curve& curve, size_t column, long shift, double sign)
{
    d.shift = shift, d.sign = sign, d.largest = 0;
    const double h = curve.rows() > 1 ? curve.t(1) - curve.t(0) : 1;
    for (size_t k = 1; k < t.size(); ++k) {  // row 0 is not compared: published runs do not set it
        const long row = std::lround(t[k] / h) - shift;
        if (row < 0 || row >= static_cast<long>(curve.rows()) || !std::isfinite(reference[k])) continue;
        if (std::abs(static_cast<double>(row + shift) * h - t[k]) > 1e-6 * h) continue;
        ++d.rows;
        d.size = std::max(d.size, std::abs(reference[k]));
        const double deviation = std::abs(reference[k] - sign * curve.at(static_cast<size_t>(row), column));
        if (deviation > d.largest) d.largest = deviation, d.t = t[k];
        if (std::isnan(deviation)) d.largest = INFINITY, d.t = t[k];
    }
    return d;
}

/// Name of the quantity in a column: "x" for column x_damped of run damped and for column x_KE5e6 of run
/// upright-KE5e6; the whole column name otherwise
std::string quantity_of(const std::string& column, const std::string& run)
{
    const size_t at = column.find('_');
    if (at == std::string::npos) return column;
    const std::string suffix = column.substr(at + 1);
    return run == suffix || run.ends_with('-' + suffix) ? column.substr(0, at) : column;
}

std::vector<ColumnMatch> matches(const io::CsvTable& table, const std::vector<NamedCurve>& curves)
{
    const std::vector<double> t = table.values("t");
    std::vector<ColumnMatch> found;
    for (const std::string& name : table.columns) {
        if (name == "t") continue;
        const std::vector<double> reference = table.values(name);
        ColumnMatch* nearest = nullptr;
        const size_t first = found.size();
        for (const NamedCurve& c : curves) {
            const size_t column = c.curve->column(quantity_of(name, c.run));
            if (c.curve->rows() == 0 || column == c.curve->columns.size()) continue;
            ColumnMatch best{.column = name, .experiment = c.experiment, .run = c.run};
            for (const long shift : {0L, 1L})
                for (const double sign : {1., -1.}) {
                    const ColumnMatch d =
                        difference({name, c.experiment, c.run}, t, reference, *c.curve, column, shift, sign);
                    if (d.rows > 0 && (best.rows == 0 || d.largest < best.largest)) best = d;
                }
            if (best.rows > 0) found.push_back(best);
        }
        for (size_t k = first; k < found.size(); ++k)
            if (nearest == nullptr || found[k].largest < nearest->largest) nearest = &found[k];
        if (nearest != nullptr) nearest->nearest = true;
    }
    if (found.empty())
        throw lie::InvalidInput(table.file + ": no column is a quantity of the selected experiments");
    return found;
}

const Columns<ColumnMatch> columns_of_matches = {
    {"column", "column", &ColumnMatch::column},
    {"experiment", "experiment", &ColumnMatch::experiment},
    {"run", "run", &ColumnMatch::run},
    {"nearest", "nearest", [](const ColumnMatch& m) { return m.nearest ? "*" : ""; }},
    {"largest difference", "largest difference", &ColumnMatch::largest},
    {"at t [s]", "at t [s]", "{:.4f}", &ColumnMatch::t},
    {"of size", "of size", "{:.4g}", &ColumnMatch::size},
    {"rows later", "rows later", "{:.0f}", &ColumnMatch::shift},
    {"sign", "sign", "{:+.0f}", &ColumnMatch::sign}};

}  // namespace

std::vector<double> PublishedGrid::values(const std::vector<std::pair<double, double>>& cells) const
{
    const io::CsvTable table = io::read_csv_table(file);
    const auto place = [](const std::vector<double>& values, double value) {
        return std::find_if(values.begin(), values.end(),
                            [&](double v) { return std::abs(v - value) < 1e-9; }) -
               values.begin();
    };
    const std::vector<double> row_values =
        table.values(row_column.empty() ? table.columns.front() : row_column);
    std::vector<double> column_values;
    for (const std::string& name : table.columns) {
        double& value = column_values.emplace_back(std::nan(""));
        std::from_chars(name.data(), name.data() + name.size(), value);
    }
    std::vector<double> all;
    for (const auto& [first, second] : cells) {
        const size_t row = place(row_values, first);
        const size_t column = header ? table.column(header(second)) : place(column_values, second);
        const bool found = row < row_values.size() && column < column_values.size();
        all.push_back(found ? table.rows[row][column] : std::nan(""));
    }
    if (std::all_of(all.begin(), all.end(), [](double v) { return std::isnan(v); }))
        throw lie::InvalidInput(file + ": has no cell of this grid; " + form);
    return all;
}

void compare_with_published(StudyContext& s, const std::vector<NamedCurve>& curves)
{
    const std::vector<ColumnMatch> found = matches(io::read_csv_table(s.against), curves);
    double largest = 0;
    for (const ColumnMatch& m : found)
        if (m.nearest) largest = std::max(largest, m.relative());
    s.measured.push_back({.of = s.against, .value = {{"difference", largest}}});
    s.text << fmt::format(
        "\ncomparison with {}: each column with every run that has the quantity; * marks the nearest "
        "run\n",
        s.against);
    columns_of_matches.print(s.text, found);
    s.text << fmt::format("largest difference of the nearest runs, relative to the column size: {:.2e}\n",
                          largest);
    s.files.emplace_back("against.csv", columns_of_matches.csv(found));
}

}  // namespace hilda::studies
