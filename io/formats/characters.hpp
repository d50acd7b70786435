// SPDX-License-Identifier: GPL-3.0-or-later
/// Classes of characters, for parsers. Unlike those of <cctype> they do not depend on the locale.

#pragma once

namespace hilda::io {

constexpr bool is_digit(char c) { return '0' <= c && c <= '9'; }

}  // namespace hilda::io
