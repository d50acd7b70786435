// SPDX-License-Identifier: GPL-3.0-or-later
/// The file run.h5 of a run, which its tables share.

#pragma once

#include "io/error.hpp"
#include "studies/running/tables/hdf5_storage.hpp"
#include "studies/running/tables/run_table.hpp"

#include <memory>
#include <string>
#include <utility>

namespace hilda::studies {

inline constexpr const char* hdf5_file_name = "run.h5";

/// An identifier of the library, closed at the end of its scope
class Hdf5Id {
public:
    Hdf5Id() = default;
    Hdf5Id(hid_t id, herr_t (*release)(hid_t)) : id(id), release(release) {}
    Hdf5Id(Hdf5Id&& other) noexcept : id(std::exchange(other.id, H5I_INVALID_HID)), release(other.release) {}
    Hdf5Id& operator=(Hdf5Id&& other) noexcept
    {
        std::swap(id, other.id), std::swap(release, other.release);
        return *this;
    }
    ~Hdf5Id()
    {
        if (id >= 0) release(id);
    }
    operator hid_t() const { return id; }  // NOLINT(google-explicit-constructor)
    /// The result of the library
    herr_t close() { return release(std::exchange(id, H5I_INVALID_HID)); }

private:
    hid_t id = H5I_INVALID_HID;
    herr_t (*release)(hid_t) = nullptr;
};

/// Creates or opens the file with the first table, and ends it with the last one. Errors of the library are
/// exceptions.
class Hdf5File {
public:
    Hdf5File(const std::string& directory, RunRecord record)
        : path(directory + '/' + hdf5_file_name), record(std::move(record))
    {}
    Hdf5File(const Hdf5File&) = delete;
    Hdf5File& operator=(const Hdf5File&) = delete;
    /// Without close_table() nothing is written: a destructor could not report an error.
    ~Hdf5File()
    {
        if (storage) storage->discard();
    }

    /// Opens the file unless another table has done so. io::IoError.
    void open_table(bool resume);
    /// Ends the file with its last table. io::IoError.
    void close_table();

    /// Group of a table; its members are listed in the order of their creation
    Hdf5Id group(const std::string& name, bool resume);
    void attribute(hid_t object, const char* name, const std::string& text) const;
    /// The result of a function of the library; io::IoError if it is negative
    template <class Result>
    Result check(Result result) const
    {
        if (result >= 0) return result;
        throw io::IoError(path + ": cannot be written: " +
                          (storage && !storage->error().empty() ? storage->error() : library_error()));
    }

    /// Makes everything that was written so far the contents of the file, see Hdf5Storage. io::IoError.
    void commit();
    /// Called after a table was created or rows were removed: the next rows are written after a commit.
    void changed() { must_commit = true; }
    void before_rows()
    {
        if (must_commit) commit();
    }
    /// Commits after every 4 MiB of compressed rows, so that the file of a killed run contains them.
    void after_rows()
    {
        if (storage->uncommitted() > 4 << 20) commit();
    }
    const std::string& name() const { return path; }
    /// True for the first call
    bool is_first_table() { return !std::exchange(has_table, true); }

private:
    /// Innermost message of the library's error stack
    static std::string library_error();

    const std::string path;
    const RunRecord record;
    std::unique_ptr<Hdf5Storage> storage;
    Hdf5Id file;  // closed before `storage` is destroyed
    int open_tables = 0;
    bool must_commit = false, has_table = false;
};

}  // namespace hilda::studies
