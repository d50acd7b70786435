// SPDX-License-Identifier: GPL-3.0-or-later
/// Measured values over time, to which a model is fitted.

#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace hilda::run {

struct FitData {
    std::string source = "data";       ///< for messages: a path
    std::vector<double> t;             ///< ascending, not negative [s]
    std::vector<std::string> columns;  ///< names of output columns, such as bar_2.rx
    Eigen::MatrixXd values;            ///< a row for each t, a column for each name; NaN: not measured

    /// io::InvalidInput "SOURCE: ..." if the instants or the shapes are wrong, if a column has no value, or
    /// if a value is infinite
    void check() const;
    long number() const;  ///< of the values that are measured
};

/// Reads a CSV file with the column t and columns of the model. `columns`: those that are read; empty: all.
/// An empty cell is a value that was not measured. io::InvalidInput with FILE:LINE; io::IoError.
FitData read_fit_data(const std::string& file, const std::vector<std::string>& columns);

}  // namespace hilda::run
