// SPDX-License-Identifier: GPL-3.0-or-later
/// The bytes of an HDF5 file, written in transactions: a virtual file driver of the HDF5 library.
///
/// The library overwrites the metadata of a file (object headers, B-trees, the superblock) in an order of its
/// own. A process that is killed in between leaves a file that cannot be read. Therefore this driver writes
/// raw data to the file at once, and holds metadata in memory until commit():
///
///     1. raw data to the disk (fdatasync)
///     2. all held metadata to FILE.journal (atomic, fsync)
///     3. metadata to the file, fdatasync
///     4. remove FILE.journal
///
/// The file has the contents of the last commit at any time, except between 3 and 4: a process killed there
/// leaves the journal, and the next opening for writing repeats step 3. Two conditions: raw data is written
/// only to space that was free at the last commit (Hdf5File commits after it removes rows), and one process
/// writes.
///
/// Alternatives not chosen: single-writer/multiple-reader (SWMR) mode needs a file format that programs with
/// HDF5 before 1.10 do not read, and a killed writer leaves a file that readers refuse; a copy of the file at
/// each checkpoint doubles its size.

#pragma once

#include <hdf5.h>

#include <cstdint>
#include <map>
#include <string>

namespace hilda::studies {

class Hdf5Storage {
public:
    /// Creates an empty file; with `resume` opens it and completes an interrupted commit. io::IoError.
    Hdf5Storage(std::string path, bool resume);
    Hdf5Storage(const Hdf5Storage&) = delete;
    Hdf5Storage& operator=(const Hdf5Storage&) = delete;
    ~Hdf5Storage();

    /// A file access property list with this storage as driver. The caller closes it. io::IoError.
    hid_t access();
    /// Makes the state after the last H5Fflush or H5Fclose that of the file. io::IoError.
    void commit();
    /// From here on nothing is written.
    void discard() { discarding = true; }
    /// Raw data since the last commit [byte]
    std::uint64_t uncommitted() const { return raw_bytes; }
    /// The first error of reading or writing: strerror text; empty if there is none
    const std::string& error() const { return error_text; }

    // Called by the driver. The first three return false after an error.
    bool read(std::uint64_t at, size_t count, char* to);
    bool write(bool raw, std::uint64_t at, size_t count, const char* from);
    bool clear();
    void set_end(std::uint64_t at) { end = at; }
    std::uint64_t allocated_end() const { return end; }
    std::uint64_t written_end() const { return written; }

private:
    void complete(const std::string& journal);
    void apply();
    bool failed();
    bool write_at(std::uint64_t at, size_t count, const char* from);
    void hold(std::uint64_t at, size_t count, const char* from);
    void patch(std::uint64_t at, size_t count, const char* from);

    const std::string path;
    int descriptor = -1;
    std::uint64_t end = 0;      ///< of the allocated space, as the library states it
    std::uint64_t written = 0;  ///< end of the bytes in the file and in `held`
    std::uint64_t raw_bytes = 0;
    std::map<std::uint64_t, std::string> held;  ///< metadata that is not in the file, by address; disjoint
    bool discarding = false;
    std::string error_text;
};

}  // namespace hilda::studies
