// SPDX-License-Identifier: GPL-3.0-or-later
/// Sinks that write a table.

#pragma once

#include "run/tables/run_table.hpp"
#include "run/tables/sink.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::run {

/// A sink with one table
class TableSink : public io::Sink<RunNode> {
public:
    TableSink(const RunSetup& run, std::string name);

    void open() override;
    void node(const RunNode& node) override;
    void sync() override { table->sync(); }
    void transfer(io::Archive& a) override;
    void close() override { table->close(); }
    std::vector<std::string> files() const override { return table->files(); }

protected:
    /// All columns; the first is time_column
    virtual std::vector<TableColumn> columns() const = 0;
    /// Appends the numbers of a node to an empty row; none if it is not a row of the table.
    virtual void append(std::vector<double>& row, const RunNode& node) = 0;
    std::string label() const { return table->label(); }

    static const TableColumn time_column;

private:
    void make();

    const std::shared_ptr<RunTables> format;
    const std::string name;
    std::unique_ptr<RunTable> table;
    std::vector<double> row;
};

/// Appends a column for each quantity.
void append(std::vector<TableColumn>& columns, const std::vector<dae::Quantity>& quantities);
/// Appends the components of a vector.
inline void append(std::vector<double>& row, const lie::Vec3& v)
{
    row.insert(row.end(), v.begin(), v.end());
}

}  // namespace hilda::run
