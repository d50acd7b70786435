// SPDX-License-Identifier: GPL-3.0-or-later
/// Tables, printed as aligned text and as CSV.

#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace hilda::studies {

class StudyText;

/// A table with named columns and cells of texts or numbers. As text, columns are aligned and numbers
/// rounded. As CSV, numbers are written with the least digits that read back exactly, and NaN is an empty
/// field. columns.hpp makes tables from rows of any type.
class Table {
public:
    using Cell = std::variant<std::string, double, long>;

    struct Column {
        std::string name;
        std::string format = "{:.3e}";  ///< fmt format of numbers in text output
    };

    explicit Table(std::vector<Column> columns) : columns(std::move(columns)) {}

    void add(std::vector<Cell> row);
    size_t rows() const { return cells.size(); }

    /// Prints the table and adds it to the tables of the text.
    void print(StudyText& out) const;
    std::string csv() const;
    /// The headings and the cells as print() shows them
    std::vector<std::vector<std::string>> shown() const;

private:
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> cells;
};

/// The text of a study for stdout, with a list of the tables that were printed to it
class StudyText : public std::ostringstream {
public:
    struct PrintedTable {
        std::string title;                           ///< the line or lines directly above the table
        std::vector<std::vector<std::string>> rows;  ///< as of Table::shown()
    };
    std::vector<PrintedTable> tables;
};

/// The number in a cell; NaN for a text
double number(const Table::Cell& cell);

/// The field of a cell in a CSV file
std::string csv_text(const Table::Cell& cell);

/// Observed order of convergence log(e₁/e₂) / log(h₁/h₂); NaN unless both errors are positive
inline double order(double h_1, double e_1, double h_2, double e_2)
{
    return e_1 > 0 && e_2 > 0 ? std::log(e_1 / e_2) / std::log(h_1 / h_2) : std::nan("");
}

/// Slope of the least-squares line through the points (log h, log e); NaN for fewer than two points
double fitted_order(const std::vector<double>& h, const std::vector<double>& e);

}  // namespace hilda::studies
