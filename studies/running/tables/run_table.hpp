// SPDX-License-Identifier: GPL-3.0-or-later
/// The tables of a run: rows of numbers, written by a format that the sinks do not know.

#pragma once

#include "io/archive.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::studies {

/// A column of an output table
struct TableColumn {
    std::string name;           ///< ENTITY.quantity
    std::string unit, meaning;  ///< meaning with frame and sign convention
    bool is_integer = false;    ///< a count; written without exponent
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
    /// Writes what a resumed run needs to the archive; or reads it, instead of open(), and removes all later rows.
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

/// One CSV file for each table
std::shared_ptr<RunTables> csv_tables(const std::string& directory);

}  // namespace hilda::studies
