// SPDX-License-Identifier: GPL-3.0-or-later
/// A JSON tree that stores the position of each value in the text, for messages of the form
/// "FILE:LINE:COL (/json/pointer): what is wrong".

#pragma once

#include "lie/check.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hilda::dae {

/// A JSON value. The members of an object have the order of the file.
struct Json {
    struct Member;
    using List = std::vector<Json>;
    using Object = std::vector<Member>;

    std::variant<std::nullptr_t, bool, double, std::string, List, Object> value;
    std::uint32_t offset = 0;  ///< position of its first byte in the text
    std::int32_t change = -1;  ///< number of the --set that gave the value, or -1

    const List* list() const { return std::get_if<List>(&value); }
    const Object* object() const { return std::get_if<Object>(&value); }
    const double* number() const { return std::get_if<double>(&value); }
    const std::string* string() const { return std::get_if<std::string>(&value); }
    const Member* member(std::string_view key) const;  ///< nullptr if missing, or if this is not an object
};

struct Json::Member {
    std::string key;
    std::uint32_t offset = 0;  ///< position of the key in the text
    Json value;
};

/// Invalid input with its location. what() begins with "FILE:LINE:COL (/json/pointer): ".
class PlacedError : public lie::InvalidInput {
public:
    using InvalidInput::InvalidInput;
};

/// Strict JSON (RFC 8259, UTF-8).
///
/// The constructor throws PlacedError for invalid JSON, for duplicate keys of an object, for numbers outside
/// the range of double, for integers of 2^53 and more, and for texts that exceed the limits below.
class JsonSource {
public:
    static constexpr std::size_t max_bytes = std::size_t{64} << 20;
    static constexpr int max_depth = 64;
    static constexpr std::size_t max_string = 4096;     ///< [bytes]
    static constexpr std::size_t max_values = 2000000;  ///< each takes about 50 bytes of memory

    Json root;

    /// `text` must outlive the object. `file` is the file name used in messages.
    JsonSource(std::string_view text, std::string file);

    /// Applies a change "/json/pointer=VALUE": replaces a value, or adds a key to an object. A VALUE that is
    /// not valid JSON is taken as a string. Throws PlacedError for an invalid pointer.
    void set(const std::string& change);

    /// Location "FILE:LINE:COL (/json/pointer)". Columns are counted in characters from 1.
    std::string place(std::size_t offset, const std::string& pointer) const;
    /// Throws PlacedError "location: what". The message also names the --set that gave the value.
    [[noreturn]] void fail(const Json& at, const std::string& pointer, const std::string& what) const;

private:
    std::string_view text;
    std::string file;
    std::vector<std::uint32_t> line_start;
    std::vector<std::string> changes;
};

/// JSON pointer of a member or element (RFC 6901): /bodies/0 and "r~/" give /bodies/0/r~0~1.
std::string pointer_to(const std::string& parent, std::string_view key);

/// The shortest decimal text that is read as the same number
std::string shortest(double x);

/// Description of a value for messages, in one line: a number, a short quoted string, or "a list of 3"
std::string described(const Json& value);

/// JSON text of a value, indented by two spaces. A list without objects is written in one line. Numbers are
/// written by shortest().
std::string written(const Json& value);

}  // namespace hilda::dae
