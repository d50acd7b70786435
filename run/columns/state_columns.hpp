// SPDX-License-Identifier: GPL-3.0-or-later
/// Columns of output tables that are functions of the state.

#pragma once

#include "run/tables/table_sink.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::run {

/// Columns of an output table that are computed together from the state at a node. The name of a column is
/// ENTITY.quantity.
class ColumnGroup {
public:
    explicit ColumnGroup(std::vector<dae::Quantity> columns) : columns(std::move(columns)) {}
    virtual ~ColumnGroup() = default;

    /// The values of all columns. The function does not allocate memory.
    virtual void values(const lie::State& x, double* out) = 0;

    const std::vector<dae::Quantity> columns;
};

/// Position, rotation matrix, velocities and accelerations of all bodies, as in trajectory.csv
std::unique_ptr<ColumnGroup> body_columns(const dae::Model& model);
/// Force::quantities() of all forces with a name
std::unique_ptr<ColumnGroup> force_columns(const dae::Model& model);
/// Normal force, gap, contact point, normal, friction and slip of all contacts, see ContactOutput
std::unique_ptr<ColumnGroup> contact_columns(const dae::Model& model);

/// A table with a row of these columns at each output row of the run. Warns once of a value that is not
/// finite.
class ColumnsSink final : public TableSink {
public:
    /// name: of the table, such as "outputs"
    ColumnsSink(const RunSetup& run, const std::string& name, std::unique_ptr<ColumnGroup> group);

private:
    std::vector<TableColumn> columns() const override;
    void append(std::vector<double>& row, const RunNode& node) override;

    const std::function<void(const std::string&)> warn;
    const std::unique_ptr<ColumnGroup> group;
    bool has_warned = false;
};

}  // namespace hilda::run
