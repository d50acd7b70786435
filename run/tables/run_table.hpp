// SPDX-License-Identifier: GPL-3.0-or-later
/// The tables of a run: rows of numbers, written by a format (CSV or HDF5) that the sinks do not know.

#pragma once

#include "dae/outputs/quantity.hpp"
#include "io/sink.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hilda::run {

/// A column of an output table, with the name ENTITY.quantity
struct TableColumn : dae::Quantity {
    bool is_integer = false;  ///< a count; written without exponent
};

/// One table in the output directory. The functions correspond to those of io::Sink.
class RunTable {
public:
    virtual ~RunTable() = default;

    /// Creates the table of a new run. io::IoError.
    virtual void open() = 0;
    /// Appends a row, one number for each column. io::IoError.
    virtual void row(const std::vector<double>& values) = 0;
    /// Synchronises with the disk what save and restore need, see transfer(). io::IoError.
    virtual void sync() = 0;
    /// Writes what a resumed run needs to the archive; or reads it, instead of open(), and removes all later
    /// rows.
    virtual void transfer(io::Archive& a) = 0;
    /// Writes what remains. io::IoError.
    virtual void close() = 0;
    /// Files that this table is the first to write
    virtual std::vector<std::string> files() const = 0;
    /// Name in messages
    virtual std::string label() const = 0;
};

/// The tables of one run in one format
class RunTables {
public:
    virtual ~RunTables() = default;
    /// A table, such as "trajectory". Writes no file.
    virtual std::unique_ptr<RunTable> table(const std::string& name, std::vector<TableColumn> columns) = 0;
};

/// Name and text of what a format with metadata stores about the run
using RunRecord = std::vector<std::pair<std::string, std::string>>;

/// One CSV file for each table
std::shared_ptr<RunTables> csv_tables(const std::string& directory);
/// One HDF5 file run.h5 with a group for each table, see docs/guide/outputs.md. io::NotAvailable if the
/// program was built without HDF5.
std::shared_ptr<RunTables> hdf5_tables(const std::string& directory, const RunRecord& record);

/// The option that chooses the format
inline constexpr const char* format_option = "--format";
inline constexpr const char* default_format = "csv";
/// The text of the option, csv or hdf5. io::UsageError for another text.
std::string table_format(const std::string& option, const std::string& text);
/// The tables in the format of the options: csv_tables() or hdf5_tables().
std::shared_ptr<RunTables> run_tables(const io::SinkOptions& options, const std::string& directory,
                                      const RunRecord& record);

}  // namespace hilda::run
