// SPDX-License-Identifier: GPL-3.0-or-later
/// Reads the keys of one JSON object: checks types and ranges, fills in defaults, and refuses keys nobody
/// asked for.

#pragma once

#include "dae/json_source.hpp"
#include "lie/so3.hpp"

#include <optional>

namespace hilda::dae {

using lie::Mat3;
using lie::Vec3;

/// Every function asks for a key, throws PlacedError where its value is not what the name of the function
/// says, and keeps what was read for the canonical text, in the order of asking. A missing key is refused
/// unless there is a fallback.
class ObjectReader {
public:
    ObjectReader(const JsonSource& source, const Json& value, std::string pointer);

    double number(std::string_view key, std::optional<double> fallback = {});
    double positive(std::string_view key, std::optional<double> fallback = {});
    double not_negative(std::string_view key, std::optional<double> fallback = {});
    int integer(std::string_view key);
    bool flag(std::string_view key, std::optional<bool> fallback = {});
    Vec3 vec3(std::string_view key, const std::optional<Vec3>& fallback = {});
    Vec3 direction(std::string_view key);  ///< three numbers, not all zero
    std::vector<double> numbers(std::string_view key, std::size_t count);
    Mat3 matrix(std::string_view key);  ///< by rows
    std::string text(std::string_view key, const std::optional<std::string>& fallback = {});
    /// A text that can stand in messages and in the head of a table: not empty, no control characters
    std::string name(std::string_view key, const std::optional<std::string>& fallback = {});
    /// One of the allowed words; "did you mean" for any other
    std::string one_of(std::string_view key, const std::vector<std::string>& allowed,
                       const std::optional<std::string>& fallback = {});
    /// A number or an expression, as the text of an expression
    std::string formula(std::string_view key, const std::optional<std::string>& fallback = {});
    /// The object under a key; keep(key, its finish()) when it has been read
    ObjectReader object(std::string_view key);
    /// The elements of a list, empty where the key is missing and may be
    const Json::List& list(std::string_view key, bool required);

    bool has(std::string_view key) const { return value.member(key) != nullptr; }
    /// The value of a key, which counts as asked for but is not kept; nullptr where it is missing
    const Json* look(std::string_view key);
    /// Refuses a key beside another that says the same.
    void exclude(std::string_view key, std::string_view other);
    /// What the canonical text shall say of a key
    void keep(std::string_view key, Json as);

    /// Refuses the keys that were not asked for, but for "note", and returns what was kept.
    Json finish();

    std::string pointer(std::string_view key) const { return pointer_to(own_pointer, key); }
    std::string place() const { return source.place(value.offset, own_pointer); }
    std::string place(std::string_view key) const;
    /// Throws PlacedError at the value of the key, or at the object where the key is missing.
    [[noreturn]] void fail(std::string_view key, const std::string& what) const;
    [[noreturn]] void fail(const std::string& what) const { source.fail(value, own_pointer, what); }

private:
    const Json* asked(std::string_view key, bool required);
    double number_at(const Json& v, const std::string& at, std::string_view key) const;
    [[noreturn]] void refuse_missing(std::string_view key);
    [[noreturn]] void refuse_unknown(const Json::Member& m) const;

    const JsonSource& source;
    const Json& value;
    std::string own_pointer;
    std::vector<std::string> known;  // keys asked for so far
    Json::Object kept;
};

/// The orientation that an object gives as one of A, p and axis_angle, or the identity. A little off is mended.
Mat3 read_orientation(ObjectReader& o);

/// A vector or matrix as a JSON list
Json json(const Vec3& v);
Json json(const Mat3& m);

}  // namespace hilda::dae
