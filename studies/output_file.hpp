// SPDX-License-Identifier: GPL-3.0-or-later
/// A growing file of results: buffered, every write checked, its length known, so that a checkpoint can name
/// it.

#pragma once

#include "studies/exit_codes.hpp"

#include <cstdint>
#include <string>

namespace hilda::studies {

class OutputFile {
public:
    /// Opens the file anew, or, to go on, cuts it to `keep` bytes. IoError names the file, also when it is
    /// shorter than that.
    explicit OutputFile(std::string path, std::uint64_t keep = 0, bool go_on = false);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    /// Does not write: flush() says whether that worked.
    ~OutputFile();

    /// What is appended here is written by the next flush().
    std::string buffer;

    /// Writes the buffer when it has grown large.
    void flush_when_full()
    {
        if (buffer.size() >= full) flush();
    }
    void flush();
    /// flush(), and down to the disk
    void sync();
    /// Length of the file with the buffer
    std::uint64_t size() const { return written + buffer.size(); }
    const std::string& name() const { return path; }

private:
    static constexpr size_t full = 1 << 20;

    std::string path;
    int descriptor = -1;
    std::uint64_t written = 0;
};

}  // namespace hilda::studies
