// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of results with published values in a CSV file (--against FILE).

#pragma once

#include "studies/framework/curve.hpp"
#include "studies/framework/study_context.hpp"

namespace hilda::studies {

/// The curve of a run of an experiment
struct NamedCurve {
    std::string experiment, run;
    const Curve* curve;
};

/// Compares all rows of curves with the columns of --against. A column "x_damped" is compared with quantity x
/// of run "damped", a column "x_KE5e6" also with that of run "upright-KE5e6", a column "x" with quantity x of
/// every run; the run with the smallest difference is marked. Rows of equal t are compared. The file may be
/// one row late and may have the opposite sign convention.
///
/// Prints a table, adds it to the files as against.csv, and measures `difference`: the largest difference of
/// a column to the nearest run, relative to the largest value of the column. lie::InvalidInput if no column
/// is a quantity of these curves.
void compare_with_published(StudyContext& s, const std::vector<NamedCurve>& curves);

/// A file with values over two parameters: a row for each value of the first, a column for each value of the
/// second
struct PublishedGrid {
    std::string file;
    std::string row_column;                     ///< column of the first parameter; "": the first column
    std::function<std::string(double)> header;  ///< of a value of the second; empty: the headers are numbers
    std::string form;                           ///< for the message if no cell is found

    /// The values of the cells (first, second parameter); NaN for a cell that the file does not have.
    /// lie::InvalidInput for a missing column, and if the file has none of the cells.
    std::vector<double> values(const std::vector<std::pair<double, double>>& cells) const;
};

}  // namespace hilda::studies
