// SPDX-License-Identifier: GPL-3.0-or-later
/// What every run and study writes the same way: directories, small files, and where a result comes from.

#pragma once

#include "studies/exit_codes.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hilda::studies {

/// Writes a file that is either the old one or the new one, never half of it: to FILE.tmp, fsync, rename,
/// fsync of the directory. IoError names the file; the temporary file is then gone.
void write_file(const std::string& path, const std::string& content);

/// Gives a file another name, in place of what may have had it, and makes that last.
void rename_file(const std::string& from, const std::string& to);

/// The whole of a file of at most `most` bytes. IoError when it cannot be read.
std::string read_file(const std::string& path, size_t most);

/// True when there is nothing at that path, or an empty directory. IoError when there is something else.
bool is_vacant(const std::string& directory);

/// Makes the directory and those above it.
void make_directory(const std::string& directory);

/// Two-space JSON and a line break; bytes that are not UTF-8 (of a command line) are replaced.
std::string as_text(const nlohmann::ordered_json& json);

/// Version, git state, flags, compiler, libraries, command line, processor, threads.
nlohmann::ordered_json provenance(const std::string& command_line, int threads);

}  // namespace hilda::studies
