// SPDX-License-Identifier: GPL-3.0-or-later
/// Files that are whole or not there.

#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace hilda::granular {

/// A file that cannot be read or written, or is not what it should be. what() names it.
class FileError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Writes beside the file, brings that to the disk and renames it.
void write_file(const std::string& file, const std::string& bytes);
std::string read_file(const std::string& file, std::size_t most);
/// FNV-1a over words of eight bytes, and over what is left
std::uint64_t checksum(const char* bytes, std::size_t count);
/// Makes a directory and those above it.
void make_directory(const std::string& directory);

}  // namespace hilda::granular
