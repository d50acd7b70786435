// SPDX-License-Identifier: GPL-3.0-or-later
/// Messages on stderr.

#pragma once

#include <cstdio>
#include <exception>
#include <string>

namespace hilda::io {

/// Writes a text to stderr. Errors of stderr (closed, or redirected to a full disk) are ignored.
inline void message(const std::string& text) noexcept
{
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

/// Writes the line "hilda: warning: WHAT".
inline void warning(const std::string& what) { message("hilda: warning: " + what + '\n'); }

/// The text that printf() would print
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// "1 row", "2 rows"; `many` is the plural if it is not `one` with an s.
std::string counted(long n, const std::string& one, const std::string& many = "");

/// Prints the error on stderr as "hilda: error: ..." and returns its exit code. All commands report their
/// errors here.
int report(const std::exception& error);

}  // namespace hilda::io
