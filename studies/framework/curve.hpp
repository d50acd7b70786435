// SPDX-License-Identifier: GPL-3.0-or-later
/// Curves: quantities of a run that are recorded at its nodes, their features, and their CSV file.

#pragma once

#include "io/archive.hpp"
#include "lie/trajectory.hpp"
#include "studies/framework/table.hpp"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace hilda::studies {

/// Named quantities with a row for each node; the first column is t [s].
class Curve {
public:
    Curve() = default;
    explicit Curve(std::vector<std::string> columns) : columns(std::move(columns)) {}

    void add(std::initializer_list<double> row) { values.insert(values.end(), row); }
    size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
    /// Index of a column; columns.size() if there is no such column
    size_t column(const std::string& name) const;
    double at(size_t row, size_t column) const { return values[row * columns.size() + column]; }
    double at(size_t row, const std::string& name) const { return at(row, column(name)); }
    double& at(size_t row, const std::string& name) { return values[row * columns.size() + column(name)]; }
    double t(size_t row) const { return at(row, 0); }
    /// Value in the last row; NaN without rows
    double last(const std::string& name) const;

    /// Time [s] of the first row with t >= from that satisfies the condition; NaN if there is none
    double first_time(const std::function<bool(size_t row)>& condition, double from = 0) const;
    /// Largest absolute value, without NaN, in the rows with t > after [s]; 0 if there are none
    double largest(const std::string& name, double after = -std::numeric_limits<double>::infinity()) const;
    /// Times [s] at which the quantity falls from a positive value to zero, by linear interpolation between
    /// the rows
    std::vector<double> zero_crossings(const std::string& name) const;
    /// Vertex of the parabola through a row and its two neighbours, whose interval is h [s]
    struct Extremum {
        double t, value;
    };
    Extremum extremum(size_t row, const std::string& name, double h) const;

    /// Writes or reads the curve.
    void transfer(io::Archive& a);

    std::vector<std::string> columns;

private:
    std::vector<double> values;
};

/// The text of a CSV file with the curves of several runs. Each row begins with the keys of its run.
class CurveTable {
public:
    CurveTable(std::vector<std::string> keys, const std::vector<std::string>& columns);
    /// Adds at most about max_rows rows of a curve, evenly distributed.
    void add(const std::vector<Table::Cell>& keys, const Curve& curve,
             size_t max_rows = std::numeric_limits<size_t>::max());
    const std::string& csv() const { return text; }

private:
    std::string text;
};

/// An observer that calls a function for each node.
class AtNodes final : public lie::Observer {
public:
    explicit AtNodes(std::function<void(const lie::State& x)> record) : record(std::move(record)) {}
    void accepted(const lie::State& x, long, int) override { record(x); }

private:
    const std::function<void(const lie::State&)> record;
};

}  // namespace hilda::studies
