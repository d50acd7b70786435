// SPDX-License-Identifier: GPL-3.0-or-later
/// Files that are written at once or read at once, and directories.

#pragma once

#include "io/error.hpp"

#include <string>

namespace hilda::io {

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

}  // namespace hilda::io
