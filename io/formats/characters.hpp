// SPDX-License-Identifier: GPL-3.0-or-later
/// Classes of characters, for parsers. Unlike those of <cctype> they do not depend on the locale.

#pragma once

#include <string>
#include <string_view>

namespace hilda::io {

constexpr bool is_digit(char c) { return '0' <= c && c <= '9'; }

/// The text in one line that a terminal shows as it is. Line breaks, control characters of ASCII and Unicode
/// and the characters that change the direction of the text are escaped as in JSON, \n and \u202e, and bytes
/// that are not UTF-8 as \x9b.
std::string printable(std::string_view text);

}  // namespace hilda::io
