// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/curve.hpp"

#include "io/formats/csv.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::studies {

size_t Curve::column(const std::string& name) const
{
    return static_cast<size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

double Curve::last(const std::string& name) const
{
    return rows() == 0 ? std::nan("") : at(rows() - 1, name);
}

double Curve::first_time(const std::function<bool(size_t)>& condition, double from) const
{
    for (size_t row = 0; row < rows(); ++row)
        if (t(row) >= from && condition(row)) return t(row);
    return std::nan("");
}

double Curve::largest(const std::string& name, double after) const
{
    double most = 0;
    const size_t k = column(name);
    for (size_t row = 0; row < rows(); ++row)
        if (t(row) > after) most = std::max(most, std::abs(at(row, k)));
    return most;
}

std::vector<double> Curve::zero_crossings(const std::string& name) const
{
    std::vector<double> times;
    const size_t k = column(name);
    for (size_t row = 1; row < rows(); ++row) {
        const double a = at(row - 1, k), b = at(row, k);
        if (a > 0 && b <= 0) times.push_back(t(row - 1) + (t(row) - t(row - 1)) * a / (a - b));
    }
    return times;
}

Curve::Extremum Curve::extremum(size_t row, const std::string& name, double h) const
{
    const size_t k = column(name);
    const double a = at(row - 1, k), b = at(row, k), c = at(row + 1, k), curvature = a - 2 * b + c;
    if (curvature == 0) return {t(row), b};
    const double offset = (a - c) / (2 * curvature);
    return {t(row) + offset * h, b - (a - c) * (a - c) / (8 * curvature)};
}

void Curve::transfer(io::Archive& a)
{
    size_t count = columns.size();
    a.count(count, sizeof(size_t));
    columns.resize(count);
    for (std::string& column : columns) a.list(column);
    a.list(values);
}

CurveTable::CurveTable(std::vector<std::string> keys, const std::vector<std::string>& columns)
{
    keys.insert(keys.end(), columns.begin(), columns.end());
    for (const std::string& name : keys) text += (text.empty() ? "" : ",") + io::csv_field(name);
    text += '\n';
}

void CurveTable::add(const std::vector<Table::Cell>& keys, const Curve& curve, size_t max_rows)
{
    std::string of_run;
    for (const Table::Cell& key : keys) of_run += (of_run.empty() ? "" : ",") + csv_text(key);
    const size_t rows = curve.rows(), stride = rows > max_rows ? (rows + max_rows - 1) / max_rows : 1;
    for (size_t row = 0; row < rows; row += stride) {
        text += of_run;
        for (size_t k = 0; k < curve.columns.size(); ++k) text += ',' + csv_text(curve.at(row, k));
        text += '\n';
    }
}

}  // namespace hilda::studies
