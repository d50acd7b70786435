// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON tree of all rooms: built in memory for output, or read from a text with positions (JsonSource).

#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace hilda::io {

/// A member of an object, with the value type Json. It is a template because Json is not yet complete here.
template <class Value>
struct JsonMember {
    std::string key;
    std::uint32_t offset = 0;  ///< position of the key in the text
    Value value;
};

/// A JSON value. The members of an object have the order of the text, or of their insertion.
///
/// Values are constructed as those of nlohmann::ordered_json: Json x = {{"name", "bar"}, {"r", {0, 0, 1}}}.
/// A braced list of pairs {"key", value} is an object, any other braced list is an array.
class Json {
public:
    using Member = JsonMember<Json>;
    using List = std::vector<Json>;
    using Object = std::vector<Member>;

    /// Numbers of a text are double. The integer types keep counters of the output exact.
    std::variant<std::nullptr_t, bool, double, long long, unsigned long long, std::string, List, Object>
        value;
    std::uint32_t offset = 0;  ///< position of its first byte in the text that was read
    std::int32_t change = -1;  ///< number of the --set that gave the value, or -1

    Json() = default;  ///< null
    Json(std::nullptr_t) {}
    Json(const char* text) : value(std::string(text)) {}
    Json(std::string text) : value(std::move(text)) {}
    Json(double number) : value(number) {}
    Json(std::same_as<bool> auto truth) : value(truth) {}
    Json(std::signed_integral auto number) : value(static_cast<long long>(number)) {}
    Json(std::unsigned_integral auto number) requires(!std::same_as<decltype(number), bool>)
        : value(static_cast<unsigned long long>(number))
    {}
    Json(List elements) : value(std::move(elements)) {}
    Json(Object members) : value(std::move(members)) {}
    template <class Element>
    Json(const std::vector<Element>& elements) : value(List(elements.begin(), elements.end()))
    {}
    Json(std::initializer_list<Json> elements);

    static Json array() { return List(); }     ///< []
    static Json object() { return Object(); }  ///< {}

    // Access to a value of one type; nullptr for a value of another type
    const List* list() const { return std::get_if<List>(&value); }
    const Object* members() const { return std::get_if<Object>(&value); }
    const double* number() const { return std::get_if<double>(&value); }
    const std::string* string() const { return std::get_if<std::string>(&value); }
    const bool* boolean() const { return std::get_if<bool>(&value); }
    const Member* member(std::string_view key) const;  ///< nullptr if missing, or if this is not an object

    /// The member of an object; it is added if there is none. Null becomes an object. std::logic_error for
    /// other values.
    Json& operator[](const std::string& key);
    /// Appends to an array. Null becomes an array. std::logic_error for other values.
    void push_back(Json element);
    /// Adds the members of an object to this one and replaces those with the same key
    void update(const Json& members);
    const Json& at(size_t element) const;  ///< element of an array; std::out_of_range
    size_t size() const;                   ///< number of elements or members; 0 for other values

    /// The text for output, indented by two spaces, with a line break at the end: each element has its own
    /// line, a double has a decimal point or an exponent, and one that is not finite is null. Bytes that are
    /// not UTF-8 are replaced by U+FFFD.
    std::string text() const;
};

/// Canonical text of a value, indented by two spaces. A list without objects is written in one line, and
/// numbers are written by shortest().
std::string written(const Json& value);

/// Description of a value for messages, in one line: a number, a short quoted string, or "a list of 3"
std::string described(const Json& value);

/// The shortest decimal text that is read as the same number
std::string shortest(double x);

/// The first characters of a text, at most 60 bytes
std::string excerpt(std::string_view text);
/// An excerpt in double quotes, with the escapes of JSON, also of all characters that printable() escapes
std::string in_quotes(std::string_view text);

/// Number of bytes of the UTF-8 character (RFC 3629) at the beginning of a text that is not empty; 0 if it is
/// ill-formed
std::size_t utf8_length(std::string_view text);

/// JSON pointer of a member or element (RFC 6901): /bodies/0 and "r~/" give /bodies/0/r~0~1.
std::string pointer_to(const std::string& parent, std::string_view key);

}  // namespace hilda::io
