// SPDX-License-Identifier: GPL-3.0-or-later
/// Messages on stderr.

#pragma once

#include <cstdio>
#include <exception>
#include <string>

namespace hilda::io {

/// Writes a text to stderr, with the escapes of printable() except for line breaks: names in it may come from
/// files of others. Errors of stderr (closed, or redirected to a full disk) are ignored.
void message(const std::string& text) noexcept;
/// Writes a text with control characters of its own, such as those of a progress line, as it is.
void raw_message(const std::string& text) noexcept;

/// Writes the line "hilda: warning: WHAT".
void warning(const std::string& what);

/// The text that printf() would print
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// "1 row", "2 rows"; `many` is the plural if it is not `one` with an s.
std::string counted(long n, const std::string& one, const std::string& many = "");

/// Prints the error on stderr as "hilda: error: ..." and returns its exit code. All commands report their
/// errors here.
int report(const std::exception& error);

}  // namespace hilda::io
