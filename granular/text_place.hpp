// SPDX-License-Identifier: GPL-3.0-or-later
/// Line and column of an entry in the text of a case.

#pragma once

#include <string>

namespace hilda::granular {

/// "LINE:COLUMN" of a byte, both counted from 1
std::string text_place(const std::string& text, std::size_t byte);
/// "LINE:COLUMN" of the value at a JSON pointer, or of the innermost existing value that contains it. The
/// text must be valid JSON.
std::string text_place(const std::string& text, const std::string& pointer);

}  // namespace hilda::granular
