// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/tables/run_table.hpp"

#include "io/nearest.hpp"
#include "run/tables/sink.hpp"

#include <cstdio>
#include <filesystem>

namespace hilda::run {

namespace {

/// Removes what a killed run has left: run.h5.TABLE.N.rows and run.h5.tmp.
void remove_rows(const std::string& directory)
{
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(directory, error))
        if (file.path().filename().string().starts_with("run.h5.")) std::remove(file.path().c_str());
}

void check_format(const std::string& option, const std::string& text) { table_format(option, text); }

// A sink type without a sink: the format belongs to the tables of all sinks.
const bool registered_run_table = io::Registry<SinkType>::add(
    {.name = "format",
     .options = {{.name = format_option,
                  .value = "csv|hdf5",
                  .help = "format of the tables: CSV files, or one HDF5 file run.h5; default: csv",
                  .check = check_format}},
     .make = [](const RunSetup&) -> std::unique_ptr<io::Sink<RunNode>> { return nullptr; },
     .files = {"run.h5"},
     .remove = remove_rows});

}  // namespace

std::string table_format(const std::string& option, const std::string& text)
{
    if (text != "csv" && text != "hdf5")
        throw io::UsageError(option + ": must be csv or hdf5, got" +
                             io::with_nearest(text, std::vector<std::string>{"csv", "hdf5"}));
    return text;
}

std::shared_ptr<RunTables> run_tables(const io::SinkOptions& options, const std::string& directory,
                                      const RunRecord& record)
{
    const auto given = options.find(format_option);
    if (given == options.end() || given->second == default_format) return csv_tables(directory);
    return hdf5_tables(directory, record);
}

}  // namespace hilda::run
