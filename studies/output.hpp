// SPDX-License-Identifier: GPL-3.0-or-later
/// Directories, small files and provenance of runs and studies.

#pragma once

#include "studies/exit_codes.hpp"
#include "studies/json.hpp"

#include <string>
#include <utility>
#include <vector>

namespace hilda::studies {

/// Writes a file atomically: to FILE.tmp, fsync, rename, fsync of the directory. After a crash the file has
/// its old or its new contents. A symbolic link is followed; a device or pipe is written to directly.
/// IoError; the temporary file is removed then.
void write_file(const std::string& path, const std::string& content);

/// Renames a file, replacing an existing file, and synchronises the directory with the disk. IoError.
void rename_file(const std::string& from, const std::string& to);

/// Contents of a regular file of at most `most` bytes. IoError.
std::string read_file(const std::string& path, size_t most);

/// True if the path does not exist or is an empty directory. IoError if it is not a directory.
bool is_missing_or_empty(const std::string& directory);

/// Creates the directory and its parents. IoError.
void make_directory(const std::string& directory);

/// Name and version of each library
std::vector<std::pair<std::string, std::string>> libraries();
/// Model name of the processor, "unknown" if the system does not tell it
std::string processor();

/// Version, git state, compiler and flags, libraries, command line, processor and number of threads, as JSON
Json provenance(const std::string& command_line, int threads);

}  // namespace hilda::studies
