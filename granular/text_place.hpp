// SPDX-License-Identifier: GPL-3.0-or-later
/// Where in the text of a case something stands.

#pragma once

#include <string>

namespace hilda::granular {

/// "LINE:COLUMN" of a byte, counted from 1
std::string text_place(const std::string& text, std::size_t byte);
/// Of the value that a JSON pointer names, or of the last on the way to it that is there. The text is JSON.
std::string text_place(const std::string& text, const std::string& pointer);

}  // namespace hilda::granular
