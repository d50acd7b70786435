// SPDX-License-Identifier: GPL-3.0-or-later
/// A table for people and for programs.

#pragma once

#include <cmath>
#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

namespace hilda::studies {

/// Rows of texts and numbers under named columns. As text its columns are aligned and numbers rounded; as CSV
/// numbers are the shortest that read back exactly, and NaN is an empty field.
class Table {
public:
    using Cell = std::variant<std::string, double>;

    struct Column {
        std::string name;
        const char* format = "{:.3e}";  ///< fmt, for people
    };

    explicit Table(std::vector<Column> columns) : columns(std::move(columns)) {}

    void add(std::vector<Cell> row);
    size_t rows() const { return cells.size(); }

    void print(std::ostream& out) const;
    std::string csv() const;

private:
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> cells;
};

/// Shortest decimal that reads back as the same double; empty for NaN.
std::string shortest(double value);

/// log(e₁/e₂) / log(h₁/h₂): the order that two errors show. NaN where there is none to see.
inline double order(double h_1, double e_1, double h_2, double e_2)
{
    return e_1 > 0 && e_2 > 0 ? std::log(e_1 / e_2) / std::log(h_1 / h_2) : std::nan("");
}

/// Slope of the straight line through (log h, log e), least squares; NaN for fewer than two points.
double fitted_order(const std::vector<double>& h, const std::vector<double>& e);

}  // namespace hilda::studies
