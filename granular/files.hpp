// SPDX-License-Identifier: GPL-3.0-or-later
/// Atomic writing and checked reading of files.

#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace hilda::granular {

/// A file cannot be read or written, or its contents are invalid. what() begins with the file name.
class FileError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Writes a file atomically: writes FILE.new, flushes it to the disk and renames it. If the writing is
/// interrupted, FILE has its old contents or does not exist. Throws FileError.
void write_file(const std::string& file, const std::string& bytes);
/// Reads a file of at most `most` bytes. Throws FileError.
std::string read_file(const std::string& file, std::size_t most);
/// 64-bit checksum: a variant of FNV-1a over words of eight bytes and the remaining single bytes, with an
/// additional shift
std::uint64_t checksum(const char* bytes, std::size_t count);
/// Creates a directory and its parents. Throws FileError.
void make_directory(const std::string& directory);

}  // namespace hilda::granular
