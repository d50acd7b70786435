// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of one JSON object. It checks types and ranges, fills in defaults, and rejects unknown keys.

#pragma once

#include "dae/json_source.hpp"
#include "lie/so3.hpp"

#include <optional>

namespace hilda::dae {

using lie::Mat3;
using lie::Vec3;

/// Each reading function returns the value of a key in the type given by the name of the function. It throws
/// PlacedError for a value of another type or outside the range, and for a missing key without a default. The
/// values are recorded for the canonical form in the order of the calls. A key that no function has requested
/// is unknown, see finish().
class ObjectReader {
public:
    ObjectReader(const JsonSource& source, const Json& value, std::string pointer);

    double number(std::string_view key, std::optional<double> fallback = {});
    double positive(std::string_view key, std::optional<double> fallback = {});
    double not_negative(std::string_view key, std::optional<double> fallback = {});
    int integer(std::string_view key);  ///< of at most 31 bits
    bool flag(std::string_view key, std::optional<bool> fallback = {});
    Vec3 vec3(std::string_view key, const std::optional<Vec3>& fallback = {});
    Vec3 direction(std::string_view key);  ///< three numbers, not all zero
    std::vector<double> numbers(std::string_view key, std::size_t count);
    Mat3 matrix(std::string_view key);  ///< by rows
    std::string text(std::string_view key, const std::optional<std::string>& fallback = {});
    /// A text that is not empty and has no control characters, for use in messages and table headers
    std::string name(std::string_view key, const std::optional<std::string>& fallback = {});
    /// One of the allowed words
    std::string one_of(std::string_view key, const std::vector<std::string>& allowed,
                       const std::optional<std::string>& fallback = {});
    /// A number or an expression, returned as the text of an expression
    std::string formula(std::string_view key, const std::optional<std::string>& fallback = {});
    /// Reader of the object under a key. Call record(key, reader.finish()) when it has been read.
    ObjectReader object(std::string_view key);
    /// The elements of a list. Empty if the key is missing and not required.
    const Json::List& list(std::string_view key, bool required);

    bool has(std::string_view key) const { return value.member(key) != nullptr; }
    /// The value of a key, or nullptr if it is missing. The key becomes known, and its value is not recorded.
    const Json* find(std::string_view key);
    /// Throws PlacedError if both of two alternative keys are given.
    void exclude(std::string_view key, std::string_view other);
    /// Records the value of a key for the canonical form. A value recorded earlier is replaced.
    void record(std::string_view key, Json as);

    /// Throws PlacedError for unknown keys, and returns the canonical form of the object. "note" is always
    /// allowed.
    Json finish();

    /// JSON pointer of a key
    std::string pointer(std::string_view key) const { return pointer_to(own_pointer, key); }
    /// Location of the object, and of the value of a key
    std::string place() const { return source.place(value.offset, own_pointer); }
    std::string place(std::string_view key) const;
    /// Throws PlacedError with the location of the value of a key, or of the object if the key is missing.
    [[noreturn]] void fail(std::string_view key, const std::string& what) const;
    [[noreturn]] void fail(const std::string& what) const { source.fail(value, own_pointer, what); }

private:
    const Json* lookup(std::string_view key, bool required);
    double number_at(const Json& v, const std::string& at, std::string_view key) const;
    [[noreturn]] void fail_missing_key(std::string_view key);
    [[noreturn]] void fail_unknown_key(const Json::Member& m) const;

    const JsonSource& source;
    const Json& value;
    std::string own_pointer;
    std::vector<std::string> known;  // keys requested so far
    Json::Object recorded;
};

/// Orientation given by one of the keys A, p and axis_angle, or the identity. Deviations from a rotation of
/// up to 1e-6 are corrected. Throws PlacedError for larger ones.
Mat3 read_orientation(ObjectReader& o);

/// A vector or matrix as a JSON list; a matrix by rows
Json json(const Vec3& v);
Json json(const Mat3& m);

}  // namespace hilda::dae
