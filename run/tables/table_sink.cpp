// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/tables/table_sink.hpp"

namespace hilda::run {

const TableColumn TableSink::time_column = {"t", "s", "time"};

void append(std::vector<TableColumn>& columns, const std::vector<dae::Quantity>& quantities)
{
    for (const dae::Quantity& q : quantities) columns.push_back({q});
}

TableSink::TableSink(const RunSetup& run, std::string name)
    : format(run.tables != nullptr ? run.tables : csv_tables(run.directory)), name(std::move(name))
{}

void TableSink::make() { table = format->table(name, columns()); }

void TableSink::open()
{
    make();
    table->open();
}

void TableSink::node(const RunNode& node)
{
    row.clear();
    append(row, node);
    if (!row.empty()) table->row(row);
}

void TableSink::transfer(io::Archive& a)
{
    if (a.reads()) make();
    table->transfer(a);
}

}  // namespace hilda::run
