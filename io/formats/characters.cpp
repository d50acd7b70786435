// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/characters.hpp"

#include "io/json.hpp"
#include "io/message.hpp"

namespace hilda::io {

namespace {

/// The code point of a well-formed character
unsigned code_of(std::string_view character)
{
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(character[k]); };
    const std::size_t n = character.size();
    unsigned code = n == 1 ? byte(0) : byte(0) & (0x7Fu >> n);
    for (std::size_t k = 1; k < n; ++k) code = code << 6 | (byte(k) & 0x3Fu);
    return code;
}

/// Control characters (C0, DEL, C1), line and paragraph separators, and marks, embeddings, overrides and
/// isolates of the direction
bool is_control(unsigned code)
{
    const auto within = [code](unsigned first, unsigned last) { return first <= code && code <= last; };
    return code < 0x20 || within(0x7F, 0x9F) || code == 0x61C || within(0x200E, 0x200F) ||
           within(0x2028, 0x202E) || within(0x2066, 0x2069);
}

}  // namespace

std::string printable(std::string_view text)
{
    std::string line;
    for (std::size_t n = 0; !text.empty(); text.remove_prefix(n)) {
        const std::size_t length = utf8_length(text);
        n = length == 0 ? 1 : length;
        const std::string_view character = text.substr(0, n);
        if (length == 0)
            line += formatted("\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(character[0])));
        else if (character == "\n")
            line += "\\n";
        else if (const unsigned code = code_of(character); is_control(code))
            line += formatted("\\u%04x", code);
        else
            line += character;
    }
    return line;
}

}  // namespace hilda::io
