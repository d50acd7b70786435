// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/text_place.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace hilda::granular {

namespace {

/// A position in a valid JSON text
class Cursor {
public:
    explicit Cursor(const std::string& text) : text(text) { skip_space(); }

    /// Moves from a value to the value at the pointer relative to it, as far as it exists.
    void follow(std::string pointer)
    {
        while (!pointer.empty()) {
            const std::size_t end = std::min(pointer.find('/', 1), pointer.size());
            if (!enter(pointer.substr(1, end - 1))) return;
            pointer.erase(0, end);
        }
    }
    std::size_t at = 0;

private:
    /// Moves from an object or an array to the member with this name or index. Returns false and does not
    /// move if there is none.
    bool enter(const std::string& name)
    {
        const std::size_t begin = at;
        const bool object = text[at] == '{';
        if (!object && text[at] != '[') return false;
        next();
        for (long k = 0; text[at] != '}' && text[at] != ']'; ++k) {
            std::string key = std::to_string(k);
            if (object) {
                const std::size_t from = at;
                skip_value();
                key = nlohmann::json::parse(text.substr(from, at - from)).get<std::string>();
                skip_space();
                next();  // the colon
            }
            if (key == name) return true;
            skip_value();
            skip_space();
            if (text[at] == ',') next();
        }
        at = begin;
        return false;
    }

    void skip_value()
    {
        int depth = 0;
        do {
            const char c = text[at];
            if (c == '"') {
                while (text[++at] != '"')
                    if (text[at] == '\\') ++at;
                ++at;
            } else if (c == '{' || c == '[') {
                ++depth, ++at;
            } else if (c == '}' || c == ']') {
                --depth, ++at;
            } else if (depth > 0) {
                ++at;
            } else {
                at = std::min(text.find_first_of(",]} \t\r\n", at), text.size());
            }
        } while (depth > 0);
    }
    void next() { ++at, skip_space(); }
    void skip_space() { at = std::min(text.find_first_not_of(" \t\r\n", at), text.size()); }

    const std::string& text;
};

}  // namespace

std::string text_place(const std::string& text, std::size_t byte)
{
    const auto to = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
    const auto line = 1 + std::count(text.begin(), to, '\n');
    const auto begin = std::find(std::make_reverse_iterator(to), text.rend(), '\n').base();
    return std::to_string(line) + ':' + std::to_string(1 + (to - begin));
}

std::string text_place(const std::string& text, const std::string& pointer)
{
    Cursor cursor(text);
    cursor.follow(pointer);
    return text_place(text, cursor.at);
}

}  // namespace hilda::granular
