// SPDX-License-Identifier: GPL-3.0-or-later
/// A JSON text as a tree whose every value knows its place, for messages "FILE:LINE:COL (/json/pointer):
/// what".

#pragma once

#include "lie/check.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hilda::dae {

/// A JSON value. Members keep the order of the file.
struct Json {
    struct Member;
    using List = std::vector<Json>;
    using Object = std::vector<Member>;

    std::variant<std::nullptr_t, bool, double, std::string, List, Object> value;
    std::uint32_t offset = 0;  ///< of its first character in the text
    std::int32_t change = -1;  ///< the --set it comes from, or -1

    const List* list() const { return std::get_if<List>(&value); }
    const Object* object() const { return std::get_if<Object>(&value); }
    const double* number() const { return std::get_if<double>(&value); }
    const std::string* string() const { return std::get_if<std::string>(&value); }
    const Member* member(std::string_view key) const;  ///< nullptr where there is none, or this is no object
};

struct Json::Member {
    std::string key;
    std::uint32_t offset = 0;  ///< of the key
    Json value;
};

/// Bad input with its place: what() begins with "FILE:LINE:COL (/json/pointer): ".
class PlacedError : public lie::InvalidInput {
public:
    using InvalidInput::InvalidInput;
};

/// Strict JSON (RFC 8259, UTF-8), read whole. Throws PlacedError for text that is not, for a key that an
/// object has twice, numbers beyond double and integers of 2^53 and more, and for more than the limits.
class JsonSource {
public:
    static constexpr std::size_t max_bytes = std::size_t{64} << 20;
    static constexpr int max_depth = 64;
    static constexpr std::size_t max_string = 4096;     ///< bytes
    static constexpr std::size_t max_values = 2000000;  ///< about 50 bytes each

    Json root;

    /// `text` must outlive the source; `file` is its name in messages.
    JsonSource(std::string_view text, std::string file);

    /// Applies "/json/pointer=VALUE": replaces a value, or adds a key to an object. VALUE is JSON, or else a
    /// string.
    void set(const std::string& change);

    /// "FILE:LINE:COL (/json/pointer)". Columns count characters from 1.
    std::string place(std::size_t offset, const std::string& pointer) const;
    /// Throws PlacedError "place: what", and names the --set that the value comes from.
    [[noreturn]] void fail(const Json& at, const std::string& pointer, const std::string& what) const;

private:
    std::string_view text;
    std::string file;
    std::vector<std::uint32_t> line_start;
    std::vector<std::string> changes;
};

/// /bodies/0 and "r~/" give /bodies/0/r~0~1 (RFC 6901).
std::string pointer_to(const std::string& parent, std::string_view key);

/// The shortest decimals that read back as the same number.
std::string shortest(double x);

/// A value in a message: a number, a short quoted string, or "a list of 3". Always one line.
std::string described(const Json& value);

/// Text of a value, indented by two spaces; a list without objects stays on one line. Numbers are shortest().
std::string written(const Json& value);

}  // namespace hilda::dae
