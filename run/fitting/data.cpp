// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fitting/data.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/nearest.hpp"
#include "io/option_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::run {

void FitData::check() const
{
    const auto refuse = [&](const std::string& what) { throw io::InvalidInput(source + ": " + what); };
    if (t.empty() || columns.empty()) refuse("has no values");
    if (values.rows() != static_cast<Eigen::Index>(t.size()) ||
        values.cols() != static_cast<Eigen::Index>(columns.size()))
        refuse(fmt::format("has {} x {} values for {} instants and {} columns", values.rows(), values.cols(),
                           t.size(), columns.size()));
    for (size_t k = 0; k < t.size(); ++k) {
        if (!std::isfinite(t[k]) || t[k] < 0)
            refuse(fmt::format("t must be finite and not negative in row {}, got {}", k + 1, t[k]));
        if (k > 0 && !(t[k] > t[k - 1]))
            refuse(fmt::format("t must increase, got {} after {} in row {}", t[k], t[k - 1], k + 1));
    }
    if (!(t.back() > 0)) refuse("t must be positive in the last row");
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
        const std::string& name = columns[static_cast<size_t>(c)];
        if (std::count(columns.begin(), columns.end(), name) > 1)
            refuse("the column " + name + " is given twice");
        for (Eigen::Index k = 0; k < values.rows(); ++k)
            if (std::isinf(values(k, c))) refuse(fmt::format("{} is infinite in row {}", name, k + 1));
        if (values.col(c).array().isNaN().all()) refuse("the column " + name + " has no value");
    }
}

long FitData::number() const { return static_cast<long>(values.size()) - values.array().isNaN().count(); }

FitData read_fit_data(const std::string& file, const std::vector<std::string>& columns)
{
    FitData data{.source = file, .t = {}, .columns = columns, .values = {}};
    std::vector<size_t> index;  // of the columns
    size_t time = 0;
    std::vector<double> cells;  // row by row
    io::read_csv(io::read_file(file, size_t(1) << 30), file, [&](const io::CsvRow& row) {
        if (index.empty()) {
            const std::vector<std::string> names(row.names.begin(), row.names.end());
            const auto find = [&](const std::string& name) {
                const auto at = std::find(names.begin(), names.end(), name);
                if (at == names.end())
                    throw io::InvalidInput(file + ": has no column" + io::with_nearest(name, names));
                return static_cast<size_t>(at - names.begin());
            };
            time = find("t");
            if (columns.empty())
                for (const std::string& name : names)
                    if (name != "t") data.columns.push_back(name);
            for (const std::string& name : data.columns) index.push_back(find(name));
            if (index.empty()) throw io::InvalidInput(file + ": has no column beside t");
        }
        const auto number = [&](size_t k) {
            if (row.cells[k].empty()) return std::numeric_limits<double>::quiet_NaN();
            const std::optional<double> value = io::number_in<double>(row.cells[k]);
            if (!value || !std::isfinite(*value))
                throw io::InvalidInput(fmt::format("{}: {}: expected a finite number, got '{}'", row.place,
                                                   row.names[k], row.cells[k]));
            return *value;
        };
        data.t.push_back(number(time));
        for (const size_t k : index) cells.push_back(number(k));
    });
    data.values = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        cells.data(), static_cast<Eigen::Index>(data.t.size()), static_cast<Eigen::Index>(index.size()));
    data.check();
    return data;
}

}  // namespace hilda::run
